"""Makes the wheel: make_wheel.py SOURCE_FOLDER BUILD_FOLDER MODULE.so READER WHEEL.whl

A wheel is a zip with a list of its files and their hashes. Two runs on one commit give the same bytes.
"""

import base64
import hashlib
import os
import pathlib
import shutil
import subprocess
import sys
import tempfile
import time
import zipfile


def run(*command, **more):
    return subprocess.run([str(word) for word in command], check=True, **more)


def needed_by(file):
    lines = run("objdump", "-p", file, capture_output=True, text=True).stdout.splitlines()
    return [line.split()[1] for line in lines if line.strip().startswith("NEEDED")]


def is_program(file):
    with open(file, "rb") as content:
        return content.read(4) == b"\x7fELF"


def rename_libraries(libraries, others):
    """Gives each library a name of its own, as auditwheel does: a process may hold another build of the same one."""
    names = {}
    for library in sorted(libraries.iterdir()):
        digest = hashlib.sha256(library.read_bytes()).hexdigest()[:8]
        stem, dot, rest = library.name.partition(".so")
        names[library.name] = f"{stem}-{digest}{dot}{rest}"
    for old, new in names.items():
        (libraries / old).rename(libraries / new)
    for file in [*sorted(libraries.iterdir()), *others]:
        # One change a call: patchelf 0.14 mixes up several.
        for needed in needed_by(file):
            if needed in names:
                run("patchelf", "--replace-needed", needed, names[needed], file)
        if file.parent == libraries:
            run("patchelf", "--set-soname", file.name, file)
        run("patchelf", "--set-rpath", "$ORIGIN" if file.parent == libraries else "$ORIGIN/../homolog.libs", file)


def write_zip(folder, wheel, seconds):
    date = time.gmtime(max(seconds, 315532800))[:6]  # a zip knows no date before 1980
    partial = wheel.with_suffix(".partial")
    with zipfile.ZipFile(partial, "w", zipfile.ZIP_DEFLATED, compresslevel=6) as archive:
        for file in sorted(path for path in folder.rglob("*") if path.is_file()):
            entry = zipfile.ZipInfo(file.relative_to(folder).as_posix(), date)
            entry.external_attr = (0o100755 if is_program(file) else 0o100644) << 16
            entry.compress_type = zipfile.ZIP_DEFLATED
            archive.writestr(entry, file.read_bytes())
    partial.replace(wheel)


def main(source, build, module, reader, wheel):
    version = wheel.name.split("-")[1]
    epoch = os.environ.get("SOURCE_DATE_EPOCH") or subprocess.run(
        ["git", "-C", str(source), "log", "-1", "--format=%ct"], capture_output=True, text=True).stdout.strip() or "0"
    with tempfile.TemporaryDirectory() as temporary:
        stage = pathlib.Path(temporary)
        package, libraries, info = stage / "homolog", stage / "homolog.libs", stage / f"homolog-{version}.dist-info"
        licences = info / "licenses"
        for folder in (package, libraries, licences):
            folder.mkdir(parents=True)
        for pattern in ("*.py", "*.pyi", "py.typed"):
            for file in (source / "python" / "homolog").glob(pattern):
                shutil.copyfile(file, package / file.name)
        own = [package / module.name, package / reader.name, package / "homolog_pictures.so"]
        for file, to in zip((module, reader, build / "portable" / "homolog_pictures.so"), own):
            shutil.copy(file, to)
        for stand_in in ("libcurl.so.4", "libjbig.so.0"):
            shutil.copyfile(build / "portable" / stand_in, libraries / stand_in)
        run("bash", "-c", '. "$0"; cd "$1"; shift; bundle "$@"', source / "packaging" / "bundle.sh", source, libraries,
            libraries, licences, *own)
        run("strip", "--strip-unneeded", *own, *libraries.iterdir())
        rename_libraries(libraries, own)
        shutil.copyfile(source / "LICENSE", licences / "LICENSE")
        rows = (line.split("\t") for line in (source / "packaging" / "libraries.tsv").read_text().splitlines())
        for package in ["pybind11-dev", *(row[3] for row in rows if row[-1] == "inside")]:
            shutil.copyfile(f"/usr/share/doc/{package}/copyright", licences / f"{package}.txt")
        (info / "WHEEL").write_text(
            "Wheel-Version: 1.0\nGenerator: homolog\nRoot-Is-Purelib: false\nTag: cp311-cp311-manylinux_2_36_x86_64\n")
        # pybind11 2.10 reads the structures of NumPy 1.
        (info / "METADATA").write_text(
            f"Metadata-Version: 2.1\nName: homolog\nVersion: {version}\n"
            "Summary: statistical shape models of organs\nLicense: MIT\nRequires-Python: >=3.11,<3.12\n"
            "Requires-Dist: numpy (>=1.21,<2)\nDescription-Content-Type: text/markdown\n\n" +
            (source / "docs" / "python.md").read_text())
        rows = []
        for file in sorted(path for path in stage.rglob("*") if path.is_file()):
            digest = base64.urlsafe_b64encode(hashlib.sha256(file.read_bytes()).digest()).rstrip(b"=").decode()
            rows.append(f"{file.relative_to(stage).as_posix()},sha256={digest},{file.stat().st_size}\n")
        rows.append(f"homolog-{version}.dist-info/RECORD,,\n")
        (info / "RECORD").write_text("".join(rows))
        wheel.parent.mkdir(parents=True, exist_ok=True)
        write_zip(stage, wheel, int(epoch))


if __name__ == "__main__":
    main(*(pathlib.Path(word) for word in sys.argv[1:]))
