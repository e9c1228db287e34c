"""What the tests of DICOM objects share: they run the program that is named first, and count what holds.

Exits with 77 where pydicom or numpy is missing.
"""
import gzip, pathlib, subprocess, sys, tempfile

try:
    import numpy
    import pydicom
except ImportError as missing:
    print(f"SKIPPED: python3-{missing.name} is not installed")
    sys.exit(77)
import make_dicom_objects as make

program = str(pathlib.Path(sys.argv[1]).resolve())
folder = pathlib.Path(tempfile.mkdtemp())
bad, held = [], []


def run(*arguments, status=0):
    ran = subprocess.run([program, *map(str, arguments)], capture_output=True, text=True)
    if ran.returncode != status:
        bad.append(f"{' '.join(map(str, arguments))}: exit {ran.returncode}, not {status}: {ran.stderr.strip()}")
    return ran


def read_nrrd(path):
    """Layers (layer, slice, row, column), spacing and directions, origin, segments {name: (layer, value, colour)}."""
    head, body = path.read_bytes().split(b"\n\n", 1)
    fields = dict(line.split(":=" if ":=" in line else ": ", 1) for line in head.decode().split("\n") if ": " in line or ":=" in line)
    types = {"uint8": "u1", "uint16": "<u2", "int16": "<i2", "float": "<f4"}
    sizes = [int(n) for n in fields["sizes"].split()]
    voxels = numpy.frombuffer(gzip.decompress(body), types[fields["type"]]).reshape(sizes[::-1])
    voxels = numpy.moveaxis(voxels, -1, 0) if len(sizes) == 4 else voxels[None]
    vectors = [v for v in fields["space directions"].split() if v != "none"]
    steps = numpy.array([[float(n) for n in v.strip("()").split(",")] for v in vectors])
    origin = numpy.array([float(n) for n in fields["space origin"].strip("()").split(",")])
    segments = {}
    for key in fields:
        if key.endswith("_Name"):
            begin = key[:-5]
            segments[fields[key]] = (int(fields[begin + "_Layer"]), int(fields[begin + "_LabelValue"]), fields.get(begin + "_Color"))
    return voxels, steps, origin, segments


def check(what, fine, shown=""):
    held.append(what)
    if not fine:
        bad.append(f"{what}: {shown}")


def compare(name, path, grid, masks, first=0, last=None, warns=None):
    """The masks, from slice `first` to `last` of the grid, are what is read."""
    out = folder / "out.seg.nrrd"
    out.unlink(missing_ok=True)
    ran = run("convert", path, out)
    check(name + " warns", (warns in ran.stderr) if warns else "warning" not in ran.stderr.replace("layers", ""), ran.stderr)
    if not out.exists():
        return
    voxels, steps, origin, segments = read_nrrd(out)
    last = len(next(iter(masks.values()))) - 1 if last is None else last
    for number, mask in masks.items():
        wanted = mask[first:last + 1]
        known = segments.get(make.NAMES.get(number))
        if known is None:
            bad.append(f"{name}: no segment {number} in {segments}")
            continue
        layer, value, colour = known
        check(f"{name} number", value == number, segments)
        read = voxels[layer]
        if read.shape != wanted.shape:
            bad.append(f"{name}: shape {read.shape}, not {wanted.shape}")
            continue
        check(f"{name} voxels of {number}", numpy.array_equal(read == value, wanted > 0), numpy.argwhere((read == value) != (wanted > 0))[:5])
    wanted_steps = numpy.array([make.SPACING[1] * grid.axes[0], make.SPACING[0] * grid.axes[1], grid.step * grid.axes[2]])
    size = numpy.array(voxels.shape[:0:-1])
    off = max(numpy.abs(origin - grid.position(first)).max(), numpy.abs((steps - wanted_steps) * size[:, None]).max())
    check(name + " place", off < 1e-3, f"{off} mm")


def compare_on(name, path, grid, masks, like, warns=None):
    """The masks are what is read on the grid of an image, all slices of it."""
    out = folder / "on.seg.nrrd"
    out.unlink(missing_ok=True)
    ran = run("convert", path, out, "--like", like)
    check(name + " warns", (warns in ran.stderr) if warns else "warning" not in ran.stderr, ran.stderr)
    voxels, steps, origin, segments = read_nrrd(out)
    check(name + " dims", voxels.shape[1:] == make.SHAPE, voxels.shape)
    for number, mask in masks.items():
        check(f"{name} voxels of {number}", numpy.array_equal(voxels[segments[make.NAMES[number]][0]] == number, mask > 0), number)
    check(name + " place", numpy.abs(origin - grid.position(0)).max() < 1e-3, origin)


def refused(name, path, *words):
    ran = run("info", path, status=1)
    check(name, all(w in ran.stderr for w in words) and len(ran.stderr.strip().split("\n")) == 1 and str(path) in ran.stderr, ran.stderr)


def write(name, ds, syntax=make.ExplicitVRLittleEndian):
    path = folder / name / "seg.dcm"
    (make.save if isinstance(syntax, pydicom.uid.UID) else make.save_encoded)(ds, path, syntax)
    return path


def finish():
    """Says what does not hold, and ends."""
    print("\n".join(bad))
    print(f"{len(held)} checks, {len(bad)} failed")
    sys.exit(1 if bad else 0)
