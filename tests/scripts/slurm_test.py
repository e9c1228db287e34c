#!/usr/bin/env python3
"""The example of a cohort on a cluster: each case is a job of a Slurm of one node, which this test starts and ends.

    slurm_test.py HOMOLOG

Prints SKIPPED and ends with 77 where there is no Slurm or no Snakemake, or where this user may not start one.
"""

import os
import shutil
import socket
import subprocess
import sys
import tempfile
import time
from pathlib import Path

from cohort_test import must, run_cohort

CONFIGURATION = """ClusterName=one
SlurmctldHost={host}(127.0.0.1)
AuthType=auth/munge
AuthInfo=socket={folder}/munge/socket
SlurmUser=root
SlurmctldPort={port}
SlurmdPort={second_port}
StateSaveLocation={folder}
SlurmdSpoolDir={folder}
SlurmctldPidFile={folder}/slurmctld.pid
SlurmdPidFile={folder}/slurmd.pid
SlurmctldLogFile={folder}/slurmctld.log
SlurmdLogFile={folder}/slurmd.log
ProctrackType=proctrack/pgid
TaskPlugin=task/none
SwitchType=switch/none
MpiDefault=none
SelectType=select/cons_tres
SelectTypeParameters=CR_Core
AccountingStorageType=accounting_storage/none
JobAcctGatherType=jobacct_gather/none
NodeName={host} NodeAddr=127.0.0.1 CPUs={cores} State=UNKNOWN
PartitionName=one Nodes={host} Default=YES MaxTime=INFINITE State=UP
"""


def free_ports(count):
    holders = [socket.create_server(("127.0.0.1", 0)) for _ in range(count)]
    ports = [holder.getsockname()[1] for holder in holders]
    for holder in holders:
        holder.close()
    return ports


class Slurm:
    """A Slurm of one node; its files lie in a folder."""

    def __init__(self, folder):
        self.folder = folder

    def __enter__(self):
        (self.folder / "munge").mkdir(mode=0o755)
        self.folder.chmod(0o755)
        key = self.folder / "munge/key"
        key.write_bytes(os.urandom(1024))
        key.chmod(0o600)
        port, second_port = free_ports(2)
        configuration = self.folder / "slurm.conf"
        configuration.write_text(CONFIGURATION.format(
            host=socket.gethostname().split(".")[0], folder=self.folder, port=port, second_port=second_port,
            cores=os.cpu_count()))
        os.environ["SLURM_CONF"] = str(configuration)
        munge = [f"--{what}={self.folder}/munge/{name}" for what, name in
                 [("key-file", "key"), ("socket", "socket"), ("pid-file", "pid"), ("log-file", "log"), ("seed-file", "seed")]]
        for command in (["munged", "--force", *munge], ["slurmctld"], ["slurmd"]):
            subprocess.run(command, check=True, capture_output=True)
        for _ in range(60):
            if "idle" in subprocess.run(["sinfo", "-h", "-o", "%T"], capture_output=True, text=True).stdout:
                return self
            time.sleep(0.5)
        sys.exit("FAILED: the node of Slurm did not come up:\n" + (self.folder / "slurmctld.log").read_text()[-2000:])

    def __exit__(self, *_):
        subprocess.run(["scontrol", "shutdown"], capture_output=True)
        pid = self.folder / "munge/pid"
        if pid.exists():
            subprocess.run(["kill", pid.read_text().strip()])
        time.sleep(1)

    def jobs(self):
        """The states of all jobs so far."""
        told = subprocess.run(["scontrol", "-o", "show", "jobs"], capture_output=True, text=True, check=True).stdout
        return [word.split("=")[1] for word in told.split() if word.startswith("JobState=")]


def main():
    homolog = Path(sys.argv[1]).resolve()
    missing = [name for name in ("snakemake", "slurmctld", "slurmd", "srun", "munged") if shutil.which(name) is None]
    if missing or os.geteuid() != 0:
        print("SKIPPED: no peer: " + (f"{missing[0]} is not installed" if missing else "only root may start a Slurm"))
        sys.exit(77)
    with tempfile.TemporaryDirectory() as name, tempfile.TemporaryDirectory() as cohort:
        with Slurm(Path(name)) as slurm:
            run_cohort(homolog, Path(cohort),
                       ["--jobs", "2", "--cluster-sync", "srun --ntasks=1 --cpus-per-task={threads}"])
            states = slurm.jobs()
    must(len(states) >= 12, f"every step is a job: {len(states)}")
    must(set(states) == {"COMPLETED"}, f"every job ends well: {states}")


if __name__ == "__main__":
    main()
