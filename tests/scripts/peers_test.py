#!/usr/bin/python3
"""Homolog and another program's library read each other's files: peers_test.py PROGRAM PEER.

PEER is nibabel, pydicom, vtk or h5py. Each file that the library writes is converted by Homolog, and each that Homolog writes
is read by the library; voxels and coordinates must be the same to the last bit, places to the format's own precision. Exit
status 77: the library is not installed. None of them is needed to build or test Homolog.
"""

import gzip
import importlib
import itertools
import json
import pathlib
import re
import subprocess
import sys
import tempfile

program, peer = pathlib.Path(sys.argv[1]).resolve(), sys.argv[2]
try:
    import numpy

    library = importlib.import_module({"vtk": "vtkmodules.all"}.get(peer, peer))
except ImportError:
    print(f"SKIPPED: no peer: python3-{peer} is not installed")
    sys.exit(77)

folder = pathlib.Path(tempfile.mkdtemp(prefix="homolog-peers-"))
faults, compared = [], 0


def fault(what):
    faults.append(what)
    print("FAULT:", what)


def homolog(*arguments):
    ran = subprocess.run([program, *map(str, arguments)], capture_output=True, text=True, cwd=folder)
    if ran.returncode != 0:
        fault(f"{' '.join(map(str, arguments))}: {ran.stderr.strip()}")
        return None
    return ran.stdout


def same(what, ours, theirs, tolerance=0.0):
    """Equal arrays; without a tolerance to the last bit of the values."""
    global compared
    compared += 1
    ours, theirs = numpy.asarray(ours), numpy.asarray(theirs)
    if ours.shape != theirs.shape:
        return fault(f"{what}: shape {ours.shape} instead of {theirs.shape}")
    wrong = numpy.abs(ours.astype(float) - theirs.astype(float)) > tolerance if tolerance else ours != theirs
    if wrong.any():
        at = tuple(numpy.argwhere(wrong)[0])
        fault(f"{what}: {wrong.sum()} values differ, first at {at}: {ours[at]} instead of {theirs[at]}")


def our_nrrd(path):
    """Voxels as [x, y, z, frame], and the affine to LPS mm, of an NRRD as Homolog writes it."""
    head, packed = path.read_bytes().split(b"\n\n", 1)
    fields = dict(line.split(": ", 1) for line in head.decode().split("\n") if ": " in line)
    sizes = [int(n) for n in fields["sizes"].split()]
    kind = {"uint8": "<u1", "int16": "<i2", "uint16": "<u2", "float": "<f4"}[fields["type"]]
    vectors = [[float(x) for x in v.split(",")] for v in re.findall(r"\(([^)]*)\)", fields["space directions"])]
    affine = numpy.eye(4)
    affine[:3, :3] = numpy.array(vectors).T
    affine[:3, 3] = [float(x) for x in fields["space origin"].strip("()").split(",")]
    return numpy.frombuffer(gzip.decompress(packed), kind).reshape(sizes, order="F"), affine


def write_nrrd(path, voxels, affine):
    """A raw NRRD, which Homolog reads."""
    names = {"uint8": "uint8", "int16": "int16", "uint16": "uint16", "float32": "float"}
    vectors = " ".join("(" + ",".join(repr(float(x)) for x in affine[:3, k]) + ")" for k in range(3))
    if voxels.ndim == 4:
        vectors += " none"
    origin = ",".join(repr(float(x)) for x in affine[:3, 3])
    head = (f"NRRD0004\ntype: {names[voxels.dtype.name]}\ndimension: {voxels.ndim}\nspace: left-posterior-superior\n"
            f"sizes: {' '.join(map(str, voxels.shape))}\nspace directions: {vectors}\nspace origin: ({origin})\n"
            f"endian: little\nencoding: raw\n\n")
    path.write_bytes(head.encode() + voxels.tobytes(order="F"))


numbers = None


def noise(kind, shape):
    """Numbers over the whole range of a type; floats of all sizes."""
    kind = numpy.dtype(kind)
    if kind.kind == "f":
        return (numbers.standard_normal(shape) * 10.0 ** numbers.integers(-9, 9, shape)).astype(kind)
    limits = numpy.iinfo(kind)
    return numbers.integers(limits.min, limits.max, shape, dtype=kind, endpoint=True)


def rotation(seed):
    q, r = numpy.linalg.qr(numpy.random.default_rng(seed).standard_normal((3, 3)))
    return q * numpy.sign(numpy.diag(r))  # left-handed for some seeds


def some_affine(seed, spacing=(0.7, 1.25, 3.3), origin=(-101.5, 33.25, 870.125)):
    affine = numpy.eye(4)
    affine[:3, :3] = (rotation(seed) if seed else numpy.eye(3)) * spacing
    affine[:3, 3] = origin
    return affine


ras = numpy.diag([-1.0, -1.0, 1.0, 1.0])  # LPS to RAS and back


def kept_as(voxels):
    """The type in which Homolog keeps whole numbers: its own where it can, else the smallest that holds them, else float."""
    return voxels if voxels.dtype.name in ("uint8", "int16", "uint16", "float32") else voxels.astype(numpy.float32)


def nibabel_files():
    nibabel = library
    for count, (kind, order, Image, ending) in enumerate(
            itertools.product(("uint8", "int16", "uint16", "int8", "float32", "float64"), "<>",
                              (nibabel.Nifti1Image, nibabel.Nifti2Image), (".nii", ".nii.gz"))):
        affine, shape = some_affine(count % 5), (7, 5, 3) if count % 3 else (4, 3, 2, 5)
        voxels = noise(kind, shape).astype(numpy.dtype(kind).newbyteorder(order))
        header = (nibabel.Nifti1Header if Image is nibabel.Nifti1Image else nibabel.Nifti2Header)(
            endianness="little" if order == "<" else "big")
        header.set_data_dtype(voxels.dtype)
        image = Image(voxels, ras @ affine, header)
        image.set_sform(ras @ affine, 1)
        image.header.set_xyzt_units("mm", "sec")
        name = f"{count}-{kind}{'le' if order == '<' else 'be'}{ending}"
        nibabel.save(image, folder / name)
        if homolog("convert", name, "ours.nrrd") is None:
            continue
        ours, place = our_nrrd(folder / "ours.nrrd")
        same(name, ours, kept_as(voxels) if kind != "int8" else voxels)
        same(f"place of {name}", place, affine, 1e-4)  # single precision
        # And back: what Homolog writes is what nibabel reads.
        back = f"ours{ending}"
        if kind in ("uint8", "int16", "uint16", "float32"):
            write_nrrd(folder / "theirs.nrrd", numpy.ascontiguousarray(voxels.astype(numpy.dtype(kind))), affine)
            if homolog("convert", "theirs.nrrd", back) is None:
                continue
            read = nibabel.load(folder / back)
            same(f"{back} of {name}", numpy.asarray(read.dataobj), voxels)
            for form in (read.get_sform(), read.get_qform()):
                same(f"place of {back} of {name}", form, ras @ affine, 1e-4)
    slope = nibabel.Nifti1Image(noise("int16", (4, 5, 6)), numpy.eye(4))
    slope.header.set_slope_inter(0.5, -1000)
    nibabel.save(slope, folder / "slope.nii")
    if homolog("convert", "slope.nii", "ours.nrrd") is not None:
        same("scaled voxels", our_nrrd(folder / "ours.nrrd")[0], nibabel.load(folder / "slope.nii").get_fdata().astype("f4"))


def write_dicom(path, plane, uid, series, syntax, place, steps, offset, number, scale, stored):
    from pydicom.dataset import FileDataset, FileMetaDataset

    meta = FileMetaDataset()
    meta.MediaStorageSOPClassUID = "1.2.840.10008.5.1.4.1.1.2"
    meta.MediaStorageSOPInstanceUID = uid
    meta.TransferSyntaxUID = library.uid.RLELossless if syntax == "RLE" else syntax
    made = FileDataset(str(path), {}, file_meta=meta, preamble=b"\0" * 128)
    made.SOPClassUID, made.SOPInstanceUID = meta.MediaStorageSOPClassUID, uid
    made.StudyInstanceUID, made.SeriesInstanceUID, made.Modality = "1.2.3", series, "CT"
    made.Rows, made.Columns = plane.shape
    made.SamplesPerPixel, made.PhotometricInterpretation = 1, "MONOCHROME2"
    made.BitsAllocated, made.BitsStored = 8 * plane.dtype.itemsize, stored
    made.HighBit, made.PixelRepresentation = stored - 1, int(plane.dtype.kind == "i")
    made.ImagePositionPatient = [f"{x:.10g}" for x in place]
    made.ImageOrientationPatient = [f"{x:.10g}" for x in steps.T.reshape(-1)]
    made.PixelSpacing, made.SliceThickness, made.InstanceNumber = ["0.75", "0.5"], "2", number
    if scale:
        made.RescaleSlope, made.RescaleIntercept = scale
    made.is_little_endian = syntax != library.uid.ExplicitVRBigEndian
    made.is_implicit_VR = syntax == library.uid.ImplicitVRLittleEndian
    made.PixelData = (plane if made.is_little_endian else plane.byteswap()).tobytes()
    made["PixelData"].VR = "OW"
    if syntax == "RLE":
        made.compress(library.uid.RLELossless, plane)
    made.save_as(path, write_like_original=False)


def pydicom_files():
    uid = library.uid
    syntaxes = (uid.ImplicitVRLittleEndian, uid.ExplicitVRLittleEndian, uid.ExplicitVRBigEndian,
                uid.DeflatedExplicitVRLittleEndian, "RLE")
    cases = itertools.product(syntaxes, (("uint8", 8), ("int16", 16), ("uint16", 12), ("uint16", 16)), (None, (2, -1024), (0.5, 3)))
    for count, (syntax, (kind, stored), scale) in enumerate(cases):
        name, steps = f"series{count}", rotation(count % 4)[:, :2] if count % 4 else numpy.eye(3)[:, :2]
        steps = numpy.round(steps, 10)
        normal = numpy.cross(steps[:, 0], steps[:, 1])
        voxels = noise(kind, (4, 3, 5))  # columns, rows, slices
        if stored < 16 and kind == "uint16":
            voxels = voxels & 4095
        (folder / name).mkdir()
        for k in numbers.permutation(5):
            place = numpy.array([10.5, -20.25, 300]) + 2 * k * normal
            write_dicom(folder / name / f"{(7 * k) % 5}.dcm", numpy.ascontiguousarray(voxels[:, :, k].T), f"1.2.9.{count}.{k + 1}",
                        f"1.2.4.{count + 1}", syntax, place, steps, 0, int(k) + 1, scale, stored)
        if homolog("convert", name, "ours.nrrd") is None:
            continue
        ours, place = our_nrrd(folder / "ours.nrrd")
        slices = sorted((library.dcmread(file) for file in (folder / name).iterdir()), key=lambda one: one.InstanceNumber)
        theirs = numpy.stack([one.pixel_array.T * float(getattr(one, "RescaleSlope", 1)) +
                              float(getattr(one, "RescaleIntercept", 0)) for one in slices], axis=2)
        same(f"{name} ({syntax}, {kind}, {scale})", ours, theirs.astype(ours.dtype))
        same(f"{name}, as pydicom reads it", ours.astype(float), theirs.astype("f4").astype(float))
        affine = numpy.eye(4)
        affine[:3, :3] = numpy.stack([steps[:, 0] * 0.5, steps[:, 1] * 0.75, normal * 2], axis=1)
        affine[:3, 3] = [10.5, -20.25, 300]
        same(f"place of {name}", place, affine, 1e-6)


def vtk_meshes():
    from vtkmodules.util import numpy_support as arrays

    vtk = library
    source = vtk.vtkSphereSource()
    source.SetThetaResolution(13)
    source.SetPhiResolution(9)
    source.Update()
    ball = source.GetOutput()
    ball.GetPointData().Initialize()

    def triangles_of(mesh):
        return arrays.vtk_to_numpy(mesh.GetPolys().GetConnectivityArray()).reshape(-1, 3)

    def points_of(mesh):
        return arrays.vtk_to_numpy(mesh.GetPoints().GetData()).astype(float)

    def ours(name):
        """Points and faces of a PLY as Homolog writes it."""
        head, body = (folder / name).read_bytes().split(b"end_header\n", 1)
        vertices, faces = (int(n) for n in re.findall(rb"element \w+ (\d+)", head))
        points = numpy.frombuffer(body, "<f8", 3 * vertices).reshape(-1, 3)
        rows = numpy.frombuffer(body, numpy.dtype([("n", "u1"), ("v", "<i4", 3)]), faces, 24 * vertices)
        return points, rows["v"]

    def check(name, tolerance=0.0):
        if homolog("convert", name, "ours.ply") is None:
            return
        points, faces = ours("ours.ply")
        if name.endswith(".stl"):  # vertices lose their numbers: compare the corners of the faces
            return same(name, points[faces].reshape(-1), points_of(ball)[triangles_of(ball)].reshape(-1))
        same(name, points, points_of(ball), tolerance)
        same(f"faces of {name}", faces, triangles_of(ball))

    def write(Writer, name, tolerance=0.0, **settings):
        writer = Writer()
        writer.SetFileName(str(folder / name))
        writer.SetInputData(ball)
        for key, value in settings.items():
            getattr(writer, key)(value)
        writer.Write()
        check(name, tolerance)

    for scale in (1.0, 33.3):
        points = vtk.vtkPoints()
        points.SetData(arrays.numpy_to_vtk((points_of(ball) * scale).astype("f4"), deep=True))
        ball.SetPoints(points)
        for kind in (1, 2):
            write(vtk.vtkPLYWriter, f"{kind}.ply", SetFileType=kind)
            write(vtk.vtkPLYWriter, f"{kind}be.ply", SetFileType=kind, SetDataByteOrder=0)
            write(vtk.vtkSTLWriter, f"{kind}.stl", SetFileType=kind)
            for version in (42, 51):
                six_digits = 6e-7 * 20 * scale if kind == 1 else 0.0  # all that VTK writes of a number in this text
                write(vtk.vtkPolyDataWriter, f"{kind}-{version}.vtk", six_digits, SetFileType=kind, SetFileVersion=version)
        for mode, order, packed in itertools.product((0, 1, 2), (0, 1), (False, True)):
            write(vtk.vtkXMLPolyDataWriter, f"{mode}{order}{packed}.vtp", SetDataMode=mode, SetByteOrder=order,
                  SetCompressor=vtk.vtkZLibDataCompressor() if packed else None)
        write(vtk.vtkOBJWriter, "a.obj")
    # And back: what Homolog writes is what VTK reads.
    writer = vtk.vtkPLYWriter()
    writer.SetFileName(str(folder / "theirs.ply"))
    writer.SetInputData(ball)
    writer.Write()
    for Reader, name in ((vtk.vtkPLYReader, "back.ply"), (vtk.vtkPolyDataReader, "back.vtk"), (vtk.vtkXMLPolyDataReader, "back.vtp"),
                         (vtk.vtkOBJReader, "back.obj"), (vtk.vtkSTLReader, "back.stl")):
        if homolog("convert", "theirs.ply", name) is None:
            continue
        reader = Reader()
        reader.SetFileName(str(folder / name))
        if name.endswith(".stl"):
            reader.MergingOff()
        reader.Update()
        read = reader.GetOutput()
        if name.endswith(".stl"):
            same(f"corners of {name}", points_of(read)[triangles_of(read)].reshape(-1), points_of(ball)[triangles_of(ball)].reshape(-1))
        else:
            same(name, points_of(read), points_of(ball))
            same(f"faces of {name}", triangles_of(read), triangles_of(ball))
    vtk_images(vtk, arrays)


def vtk_images(vtk, arrays):
    """MetaImage and NRRD, which VTK reads by its own code; of MetaImage it also writes."""
    def values_of(image):
        return arrays.vtk_to_numpy(image.GetPointData().GetScalars()).reshape(-1)

    for kind, packed in itertools.product(("uint8", "int16", "uint16", "float32"), (True, False)):
        voxels = noise(kind, (6, 4, 3))
        image = vtk.vtkImageData()
        image.SetDimensions(6, 4, 3)
        image.SetSpacing(0.5, 0.75, 2)
        image.SetOrigin(-3, 4.5, 100)
        image.GetPointData().SetScalars(arrays.numpy_to_vtk(voxels.reshape(-1, order="F"), deep=True))
        writer = vtk.vtkMetaImageWriter()
        writer.SetFileName(str(folder / "theirs.mha"))
        writer.SetInputData(image)
        writer.SetCompression(packed)
        writer.Write()
        affine = some_affine(0, (0.5, 0.75, 2), (-3, 4.5, 100))
        if homolog("convert", "theirs.mha", "ours.nrrd") is not None:
            ours, place = our_nrrd(folder / "ours.nrrd")
            same(f"VTK's MetaImage of {kind}", ours, voxels)
            same(f"place of VTK's MetaImage of {kind}", place, affine, 1e-6)
        write_nrrd(folder / "theirs.nrrd", voxels, affine)
        for Reader, source, name in ((vtk.vtkMetaImageReader, "theirs.nrrd", "ours.mha"), (vtk.vtkNrrdReader, "theirs.nrrd", "ours.nrrd")):
            if homolog("convert", source, name) is None:
                continue
            reader = Reader()
            reader.SetFileName(str(folder / name))
            if hasattr(reader, "SetController"):  # Debian's reads NRRD in parallel
                reader.SetController(vtk.vtkDummyController())
            reader.Update()
            same(f"{name} of {kind} by VTK", values_of(reader.GetOutput()), voxels.reshape(-1, order="F"))
            if name.endswith(".mha"):  # of NRRD, VTK takes the first axis for components
                same(f"spacing of {name} by VTK", reader.GetOutput().GetSpacing(), (0.5, 0.75, 2))
                same(f"origin of {name} by VTK", reader.GetOutput().GetOrigin(), (-3, 4.5, 100))


def h5py_models():
    h5py = library
    if homolog("phantom", "kidney", "--subject", "1", "-o", ".") is None:
        return
    shapes = ["kidney-1-truth.ply"]
    for k in (2, 3):
        homolog("phantom", "kidney", "--subject", k, "-o", ".")
        shapes.append(f"kidney-{k}-truth.ply")
    for name in ("m.h5", "m.h5.json"):
        homolog("model", *shapes, "-o", name)
    tree = json.loads((folder / "m.h5.json").read_text())
    ours = {entry["alias"][0]: entry["value"] for entry in tree["datasets"].values()}
    said = homolog("info", "m.h5", "--json")
    # What Homolog writes is what h5py reads, as its own JSON says it.
    with h5py.File(folder / "m.h5") as file:
        for path, value in ours.items():
            if "ime" in path:  # the time of writing
                continue
            theirs = file[path][()]
            if isinstance(theirs, bytes):
                if theirs.decode() != value:
                    fault(f"{path}: {theirs.decode()} instead of {value}")
                continue
            same(path, theirs, numpy.array(value, theirs.dtype).reshape(theirs.shape))
        # What h5py writes in other ways is what Homolog reads.
        for count, (order, wide, chunk, packing) in enumerate(itertools.product("<>", (4, 8), (False, True), (None, "gzip"))):
            if packing and not chunk:
                continue
            name = f"theirs{count}.h5"
            with h5py.File(folder / name, "w") as copy:
                def put(path, item):
                    if isinstance(item, h5py.Group):
                        made = copy.require_group(path)
                    else:
                        value = item[()]
                        if isinstance(value, numpy.ndarray) and value.ndim > 0:
                            kind = f"{order}{value.dtype.kind}{wide}"
                            made = copy.create_dataset(path, data=value.astype(kind), chunks=True if chunk else None, compression=packing)
                        else:
                            made = copy.create_dataset(path, data=value, dtype=item.dtype)
                    for key, text in item.attrs.items():
                        made.attrs[key] = text
                file.visititems(put)
            other = homolog("info", name, "--json")
            global compared
            compared += 1
            if other != said:
                fault(f"{name} ({order}, {wide} bytes, {packing}) is read as another model")
        with h5py.File(folder / "shifted.h5", "w") as copy:
            file.copy("/model", copy), file.copy("/representer", copy), file.copy("/modelinfo", copy), file.copy("/version", copy)
            mean = copy["model/mean"][()]
            mean[:3] += 1000
            copy["model/mean"][...] = mean
        bounds = json.loads(homolog("info", "shifted.h5", "--json") or "{}").get("bounds_mm")
        same("bounds of a mean that h5py changed", bounds, [mean.reshape(-1, 3).min(0), mean.reshape(-1, 3).max(0)])


numbers = numpy.random.default_rng(5)
{"nibabel": nibabel_files, "pydicom": pydicom_files, "vtk": vtk_meshes, "h5py": h5py_models}[peer]()
subprocess.run(["rm", "-rf", str(folder)])
print(f"{peer} {getattr(library, '__version__', '')}: {compared} comparisons, {len(faults)} faults")
sys.exit(1 if faults or compared < 20 else 0)
