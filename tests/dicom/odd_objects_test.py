#!/usr/bin/python3
"""What is odd in DICOM objects but legal, or seen in hospitals, is read as it stands, or said, or refused; nothing moves silently.

odd_objects_test.py PROGRAM. Exits with 77 where pydicom or numpy is missing.
"""


from checks import check, finish, folder, make, numpy, pydicom, read_nrrd, refused, run, write

masks = make.blobs()
labels = (masks[1] + 2 * masks[2]).astype(numpy.uint8)


def series_at(name, grid, places):
    """The series, each image moved to a place."""
    make.write_series(folder / name, grid)
    for k, place in enumerate(places):
        ds = pydicom.dcmread(folder / name / f"ct{k:03}.dcm")
        ds.ImagePositionPatient = [make.number(v) for v in place]
        ds.save_as(folder / name / f"ct{k:03}.dcm")
    return folder / name


def seg_at(name, grid, places, like="dcmqi", images=None):
    """The segmentation of it; `images`: the image that the frames of each slice refer to."""
    ds = make.seg(masks, grid, like=like)
    for group in ds.PerFrameFunctionalGroupsSequence:
        place = group.PlanePositionSequence[0]
        k = round((numpy.array(place.ImagePositionPatient, float) - grid.position(0)) @ grid.axes[2] / grid.step)
        place.ImagePositionPatient = [make.number(v) for v in places[k]]
        if images:
            source = group.DerivationImageSequence[0].SourceImageSequence[0]
            source.ReferencedSOPInstanceUID = f"{make.SERIES}.{images[k] + 1}"
    return write(name, ds)


def on(name, path, like, wanted, *words, status=0):
    """The labels that are read on the grid of an image, and what is said."""
    out = folder / "odd.seg.nrrd"
    out.unlink(missing_ok=True)
    ran = run("convert", path, out, *(["--like", like] if like else []), status=status)
    check(name + " says", all(w in ran.stderr for w in words) and (words or "warning" not in ran.stderr), ran.stderr)
    if out.exists():
        read = read_nrrd(out)[0]
        check(name, read.shape == (1, *wanted.shape) and numpy.array_equal(read[0], wanted), read)
    return ran


# Frames lie where their images do, also where these are shifted to the side by more than a quarter of a pixel.
rng = numpy.random.default_rng(3)
for oblique in (False, True):
    kind, grid = "oblique" if oblique else "straight", make.Grid(oblique)
    shifts = [numpy.array([*rng.uniform(-.04, .04, 2), 0]) @ grid.axes for _ in range(9)]
    shifts[2], shifts[6] = numpy.array([.1, .03, 0]) @ grid.axes, numpy.array([-.1, -.03, 0]) @ grid.axes
    places = [grid.position(k) + shifts[k] for k in range(9)]
    ct = series_at(f"jitter {kind}", grid, places)
    path = seg_at(f"of jitter {kind}", grid, places)
    on(f"jitter {kind}", path, ct, labels, "images that they refer to", "off even ones")
    refused(f"jitter alone {kind}", path, "shifted sideways", "--like")
    beside = ct / "seg.bin"
    beside.write_bytes(path.read_bytes())
    on(f"jitter beside {kind}", beside, None, labels, "images that they refer to")
    beside.unlink()
    # Against their own images, they are not: they may be of another grid.
    away = [place + numpy.array([.2, 0, 0]) @ grid.axes for place in places]
    on(f"jitter away {kind}", seg_at(f"away {kind}", grid, away), ct, labels, "sideways", status=1)
    even = [grid.position(k) for k in range(9)]
    away = [place + numpy.array([.2, 0, 0]) @ grid.axes for place in even]
    make.write_series(folder / f"even {kind}", grid)
    on(f"even away {kind}", seg_at(f"even away {kind}", grid, away), folder / f"even {kind}", labels, "does not lie on the voxels",
       status=1)
    # A frame that refers to the image of another slice lies where it says.
    swapped = [0, 1, 3, 2, 4, 5, 6, 7, 8]
    on(f"other image {kind}", seg_at(f"other image {kind}", grid, even, images=swapped), folder / f"even {kind}", labels,
       "lies on slice 3 of its series and refers to the image of slice 4", "its place was taken")
    # A little off is said by how much.
    near = [place + numpy.array([.11, 0, 0]) @ grid.axes for place in even]
    on(f"near {kind}", seg_at(f"near {kind}", grid, near), folder / f"even {kind}", labels, "up to 0.11 mm off")

# Without the sequence that names the series the images tell it.
grid = make.Grid()
ds = make.seg({1: masks[1]}, grid, like="dcmqi", spacing=None, thickness=None)
del ds.ReferencedSeriesSequence
path = write("no series named", ds)
make.write_series(path.parent, grid)
on("no series named", path, None, masks[1])

# Label maps that others compressed: the same values, and none where the encoding changes them.
ENCODED = (
    ("1.2.840.10008.1.2.4.70",
     ("ffd8ffc3000b080020002001011100ffc40017000101010100000000000000000000000000010208ffda0008010100010000"
        "e7f000000000000000000000000000000000000000000000000000000000000000000500800000a004000014002000028001"
        "0000500008000500008000500008000500008000500008000500008000500008000500008003408000800340800100034080"
        "020003408004000340cd00800000000000000000000000000000000000000000000000000000000001ffd900"),
     ("ffd8ffc3000b100020002001011100ffc40017000101010100000000000000000000000000010210ffda0008010100010000"
        "e000000000000000000000000000000000000000000000000000000000000000000500800000a00400001400200002800100"
        "0050000800050000800050000800050000800050000800050000800050000800050000800340800080034080010003408002"
        "0003408004000340cd00800000000000000000000000000000000000000000000000000000000001ffd9")),
    ("1.2.840.10008.1.2.4.80",
     ("ffd8fff7000b080020002001011100ffda0008010100000000ff7fff45595f326c2651cbb3f4b66f3e6d19b466d19b466d19"
        "b466d18de765c75d2ceb9dceb93ceab47fff00ffd900"),
     ("ffd8fff7000b100020002001011100fff8000d01ffff0012004301140040ffda0008010100000000ff7fff45401801004010"
        "0804020101052600c0026005100c00b8033c03004b006680c027804d00a20134028809a028809a028809a028809a02881340"
        "a20470381801008181809604701605201009c0581380403380b02501019c05850148080fff40ffd9")),
    ("1.2.840.10008.1.2.4.90",
     ("ff4fff510029000000000020000000200000000000000000000000200000002000000000000000000001070101ff52000c00"
        "000001000404040001ff5c00104040484850484850484850484850ff64002a000143726561746564206279204744434d2f4f"
        "70656e4a5045472076657273696f6e20322e352e30ff90000a0000000000630001ff93df80300647dc0a929fc010c010c008"
        "400a0a07c03a2403a24009001e74a4671a8157bf0840708fc013c0134009001a1d44f836f0a31e75ad0e8f963bc4915fc012"
        "40124009c08df945538e1b60bf7320605def3b1dffd9"),
     ("ff4fff5100290000000000200000002000000000000000000000002000000020000000000000000000010f0101ff52000c00"
        "000001000404040001ff5c00104080888890888890888890888890ff64002a000143726561746564206279204744434d2f4f"
        "70656e4a5045472076657273696f6e20322e352e30ff90000a0000000000740001ff93dff890500647dc0a92800000001fc0"
        "0010c00010c00008400a0a07c0003a240003a2400009001e74a4671a8157bf0840708fc00013c00013400009001a1d44f836"
        "f0a31e75ad0e8f963bc4915fc00012400012400009c08df945538e1b60bf7320605def3b1dffd900")),
    ("1.2.840.10008.1.2.5",
     ("0100000040000000000000000000000000000000000000000000000000000000000000000000000000000000000000000000"
        "0000000000000000000000000000e100e100e100e100e100e100e100e100f700f801f400f800f601f500f900f401f600fa00"
        "f201f700fb00f001f800fb00f001f800fb00f001f800fb00f001f800fb00f001f800fb00f001f800fb00f001f800fb00f001"
        "f800fe00fb02f301f800fe00fb02f401f700fe00fb02f501f600fe00fb02f601f500fe00fb020000f801f400e100e100e100"
        "e100e100e100e100"),
     ("0200000040000000800000000000000000000000000000000000000000000000000000000000000000000000000000000000"
        "0000000000000000000000000000e100e100e100e100e100e100e100e100e100e100e100e100e100e100e100e100e100e100"
        "e100e100e100e100e100e100e100e100e100e100e100e100e100e100e100e100e100e100e100e100e100e100f700f801f400"
        "f800f601f500f900f401f600fa00f201f700fb00f001f800fb00f001f800fb00f001f800fb00f001f800fb00f001f800fb00"
        "f001f800fb00f001f800fb00f001f800fe00fb02f301f800fe00fb02f401f700fe00fb02f501f600fe00fb02f601f500fe00"
        "fb020000f801f400e100e100e100e100e100e100e100")),
)
j, i = numpy.indices((32, 32))[0], numpy.indices((32, 32))[1]
disc = ((j - 16) ** 2 + (i - 14) ** 2 < 81).astype(numpy.uint8)
disc[20:25, 3:9] = 2
for syntax, bytes_of, words_of in ENCODED:
    for dtype, plane in ((numpy.uint8, bytes_of), (numpy.uint16, words_of)):
        ds = make.seg({0: disc[None].astype(dtype)}, grid, "LABELMAP", numbers=[1, 2])
        make.encode(ds, [make.padded(bytes.fromhex(plane))])
        name = f"{syntax} {dtype.__name__}"
        on(name, write(name, ds, syntax), None, disc[None])
ds = make.seg({0: disc[None]}, grid, "LABELMAP", numbers=[1, 2])
make.encode(ds, [bytes.fromhex("ffd8ffdb00430001010101010101010101010101")])
refused("changed labels", write("changed labels", ds, "1.2.840.10008.1.2.4.50"), "1.2.840.10008.1.2.4.50 (JPEG Baseline)", "changes them",
        "uncompressed")

# Another resolution than the image's stays what it is, and is no map of its voxels.
fine = {n: mask.repeat(2, 1).repeat(2, 2) for n, mask in masks.items()}
kept, make.SPACING = make.SPACING, (0.375, 0.25)
ds = make.seg(fine, make.Grid(origin=numpy.array((-31.25, 12.5, 100.0)) - [.125, .1875, 0]))
make.SPACING = kept
path = write("fine", ds)
on("fine", path, None, (fine[1] + 2 * fine[2])[2:7])
make.write_series(folder / "ct", grid)
on("fine on its image", path, folder / "ct", labels, "does not lie on the voxels", status=1)

# Frames of segments in turn, columns and rows exchanged, rows that run back.
ds = make.seg(masks, grid)
held = [(n, k) for n in (1, 2) for k in range(9) if masks[n][k].any()]
order = sorted(range(len(held)), key=lambda f: held[f][::-1])
ds.PerFrameFunctionalGroupsSequence = pydicom.Sequence([ds.PerFrameFunctionalGroupsSequence[f] for f in order])
ds.PixelData = make.padded(numpy.packbits(numpy.stack([masks[n][k] for n, k in (held[f] for f in order)]).ravel() > 0, bitorder="little").tobytes())
on("in turn", write("in turn", ds), folder / "ct", labels)
ds = make.seg({n: numpy.swapaxes(mask, 1, 2).copy() for n, mask in masks.items()}, grid)
shared = ds.SharedFunctionalGroupsSequence[0]
shared.PlaneOrientationSequence[0].ImageOrientationPatient = [0, 1, 0, 1, 0, 0]
shared.PixelMeasuresSequence[0].PixelSpacing = [0.5, 0.75]
on("exchanged", write("exchanged", ds), folder / "ct", labels)

# Contours that are there twice are one; what is not taken as it stands is said.
def drawn(name, contours, *words, change=None, syntax=make.ExplicitVRLittleEndian, wanted=None):
    ds = make.rtstruct({1: ("A", contours)})
    if change:
        change(ds.ROIContourSequence[0].ContourSequence[0])
    on(name, write(name, ds, syntax), folder / "ct", box if wanted is None else wanted, *words)


square = [(0.6, 0.6), (4.4, 0.6), (4.4, 3.4), (0.6, 3.4)]
box = numpy.zeros(make.SHAPE)
box[2, 1:4, 1:5] = 1
one = ("CLOSED_PLANAR", make.on_plane(grid, 2, square))
drawn("twice", [one, one], "1 contour twice; one of each was taken")
drawn("cancelled", [("CLOSEDPLANAR_XOR", one[1])] * 2, "no voxel", wanted=0 * box)
drawn("few points", [one, ("CLOSED_PLANAR", make.on_plane(grid, 3, square[:2])), ("CLOSED_PLANAR", make.on_plane(grid, 4, square[:1]))],
      "2 contours of fewer than three points")
drawn("of no kind", [one], "of no kind; closed ones were assumed", change=lambda c: c.__delitem__("ContourGeometricType"))
drawn("unknown kind", [one], "of the kind CLOSED_ROUND", change=lambda c: setattr(c, "ContourGeometricType", "CLOSED_ROUND"))
drawn("offset", [one], "1 contour with an offset", change=lambda c: setattr(c, "ContourOffsetVector", [0, 0, 5]))

# Contours of another study that name no image are said, and those that name the images are not.
ds = make.rtstruct({1: ("A", [one])})
ds.StudyInstanceUID = "1.2.3.4"
path = write("of another study", ds)
ran = run("convert", path, folder / "study.seg.nrrd", "--like", folder / "ct")
check("another study with images", "warning" not in ran.stderr, ran.stderr)
del ds.ReferencedFrameOfReferenceSequence[0].RTReferencedStudySequence
ran = run("convert", write("of another study alone", ds), folder / "study.seg.nrrd", "--like", folder / "ct")
check("another study", f"is of the study 1.2.3.4, and {folder / 'ct'} of the study {make.STUDY}" in ran.stderr, ran.stderr)

# On slices that are resampled each slice has the contours of the old one nearest to it, moved as its pixels were.
uneven = make.Grid()
heights = [0, 2, 4, 6, 8, 10, 13, 16, 19]
ct = series_at("uneven", uneven, [uneven.origin + [0, 0, z] for z in heights])
corners = [numpy.array(p) - grid.position(2) for p in one[1]]
path = write("on uneven", make.rtstruct({1: ("A", [("CLOSED_PLANAR", [c + uneven.origin + [0, 0, heights[k]] for c in corners]) for k in (2, 6)])}))
ran = run("convert", path, folder / "u.seg.nrrd", "--like", ct, "--resample")
voxels = read_nrrd(folder / "u.seg.nrrd")[0][0]  # at 0, 2, 4, …: 12 and 14 lie nearest to 13
check("resampled contours", numpy.flatnonzero(voxels.any(axis=(1, 2))).tolist() == [2, 6, 7] and
      all(numpy.array_equal(voxels[k], box[2]) for k in (2, 6, 7)), voxels.any(axis=(1, 2)))
check("resampled contours say", "nearest to it, up to 1.00 mm away" in ran.stderr, ran.stderr)
tilted = [uneven.origin + [0, 1.5 * k, 2.5 * k] for k in range(9)]
ct = series_at("tilted", uneven, tilted)
path = write("on tilted", make.rtstruct({1: ("A", [("CLOSED_PLANAR", [c + tilted[k] for c in corners]) for k in (0, 3)])}))
ran = run("convert", path, folder / "t.seg.nrrd", "--like", ct, "--resample")
voxels, _, origin, _ = read_nrrd(folder / "t.seg.nrrd")
check("tilted contours", [numpy.argwhere(voxels[0][k]).min(axis=0).tolist() for k in (0, 3)] == [[1, 1], [7, 1]] and
      voxels[0].sum() == 24, numpy.argwhere(voxels[0]))

# Soft masks are written as fractional segments.
shares = numpy.zeros(make.SHAPE, numpy.uint8)
shares[2], shares[5] = numpy.arange(35).reshape(5, 7) * 7, 200
make.NAMES.update({5: "Lesion", 7: "Edge"})
for name, given in (("one share", {5: shares}), ("two shares", {5: shares, 7: shares[::-1].copy()})):
    source = write(name, make.seg(given, grid, "FRACTIONAL", full=250))
    ran = run("convert", source, folder / "soft.dcm", "--like", folder / "ct")
    ds = pydicom.dcmread(folder / "soft.dcm")
    check(name + " kind", (ds.SegmentationType, ds.BitsAllocated, ds.SegmentationFractionalType) == ("FRACTIONAL", 8, "PROBABILITY") and
          [s.SegmentLabel for s in ds.SegmentSequence] == [make.NAMES[n] for n in given] and "255ths" not in ran.stderr, ran.stderr)
    for group, frame in zip(ds.PerFrameFunctionalGroupsSequence, numpy.frombuffer(ds.PixelData, numpy.uint8)[:35 * ds.NumberOfFrames].reshape(-1, 5, 7)):
        n = list(given)[group.SegmentIdentificationSequence[0].ReferencedSegmentNumber - 1]
        k = int(group.DerivationImageSequence[0].SourceImageSequence[0].ReferencedSOPInstanceUID.rsplit(".", 1)[1]) - 1
        check(name, numpy.abs(frame / ds.MaximumFractionalValue - given[n][k] / 250).max() < 1e-6, (n, k))
    check(name + " frames", ds.NumberOfFrames == sum(bool(mask[k].any()) for mask in given.values() for k in range(9)), ds.NumberOfFrames)
    run("convert", source, folder / "again.dcm", "--like", folder / "ct")
    check(name + " bytes", (folder / "soft.dcm").read_bytes() == (folder / "again.dcm").read_bytes())

finish()
