#!/usr/bin/python3
"""Checks a wheel as auditwheel would: check_wheel.py WHEEL.whl. Prints what it found; exit status 1 where it finds a fault.

- No symbol is newer than the tag promises (manylinux_2_36).
- A library that is needed lies in the wheel, or is one that the policy lets a system have.
- RPATH leads into the wheel and nowhere else.
- Each library in the wheel has a name of its own, so that it is not taken for another build of the same one.
- The list of files is whole, and each hash is right.
"""

import base64
import csv
import hashlib
import io
import pathlib
import re
import subprocess
import sys
import tempfile
import zipfile

# From auditwheel's policy of manylinux_2_36.
NEWEST = {"GLIBC": (2, 36), "GLIBCXX": (3, 4, 30), "CXXABI": (1, 3, 13), "GCC": (12, 0, 0)}
FROM_SYSTEM = {"libgcc_s.so.1", "libstdc++.so.6", "libm.so.6", "libc.so.6", "libdl.so.2", "librt.so.1",
               "libpthread.so.0", "libresolv.so.2", "libutil.so.1", "ld-linux-x86-64.so.2"}


def output_of(*command):
    return subprocess.run(command, check=True, capture_output=True, text=True).stdout


def faults_of_library(file, in_wheel):
    text = output_of("objdump", "-p", str(file))
    for kind, version in re.findall(r"^\s+0x[0-9a-f]+ 0x[0-9a-f]+ \d+ ([A-Z]+)_([0-9.]+)$", text, re.MULTILINE):
        newest = NEWEST.get(kind)
        if newest and tuple(int(part) for part in version.split(".")) > newest:
            yield f"needs {kind}_{version}, which is newer than the tag promises"
    for needed in re.findall(r"NEEDED\s+(\S+)", text):
        if needed not in FROM_SYSTEM and needed not in in_wheel:
            yield f"needs {needed}, which is neither in the wheel nor in every system"
    for path in re.findall(r"(?:RPATH|RUNPATH)\s+(\S+)", text):
        if path not in ("$ORIGIN", "$ORIGIN/../homolog.libs"):
            yield f"looks for libraries in {path}, which is outside of the wheel"
    name = re.search(r"SONAME\s+(\S+)", text)
    if file.parent.name == "homolog.libs" and (not name or name[1] != file.name or not re.search(r"-[0-9a-f]{8}\.so", file.name)):
        yield "has no name of its own"


def faults_of_list(archive):
    record = next(name for name in archive.namelist() if name.endswith(".dist-info/RECORD"))
    rows = {name: digest for name, digest, _ in csv.reader(io.StringIO(archive.read(record).decode()))}
    for name in archive.namelist():
        digest = base64.urlsafe_b64encode(hashlib.sha256(archive.read(name)).digest()).rstrip(b"=").decode()
        if name != record and rows.get(name) != f"sha256={digest}":
            yield f"{name}: is not in RECORD as it is"
    for name in rows.keys() - set(archive.namelist()):
        yield f"{name}: is in RECORD and not in the wheel"


def main(wheel):
    faults = []
    if "-cp311-cp311-manylinux_2_36_x86_64" not in wheel.name:
        faults.append(f"{wheel.name}: has another tag than cp311-cp311-manylinux_2_36_x86_64")
    with tempfile.TemporaryDirectory() as folder, zipfile.ZipFile(wheel) as archive:
        faults += faults_of_list(archive)
        archive.extractall(folder)
        libraries = sorted(path for path in pathlib.Path(folder).rglob("*") if path.is_file() and path.read_bytes()[:4] == b"\x7fELF")
        in_wheel = {path.name for path in libraries if path.parent.name == "homolog.libs"}
        for file in libraries:
            faults += [f"{file.name}: {fault}" for fault in faults_of_library(file, in_wheel)]
    for fault in faults:
        print(fault)
    print(f"{wheel.name}: {len(libraries)} libraries and programs, {wheel.stat().st_size / 1e6:.1f} MB, {len(faults)} faults")
    return 1 if faults else 0


if __name__ == "__main__":
    sys.exit(main(pathlib.Path(sys.argv[1])))
