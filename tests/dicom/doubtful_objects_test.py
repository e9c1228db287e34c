#!/usr/bin/python3
"""DICOM objects that are whole only at first sight are read as they are meant, or said, or refused by name.

doubtful_objects_test.py PROGRAM. Exits with 77 where pydicom or numpy is missing.
"""
from checks import check, compare, finish, folder, make, numpy, pydicom, read_nrrd, refused, run, write

masks = make.blobs()
labels = (masks[1] + 2 * masks[2]).astype(numpy.uint8)
grid = make.Grid()


def frames_of(given):
    """The planes of a segmentation in the order of its frames."""
    return [mask[k] > 0 for mask in given.values() for k in range(len(mask)) if mask[k].any()]


# Frames that each begin with a byte of their own, though they are not compressed.
def in_bytes(given, more=b""):
    ds = make.seg(given, grid)
    ds.PixelData = make.padded(b"".join(numpy.packbits(f.ravel(), bitorder="little").tobytes() for f in frames_of(given)) + more)
    return ds


more_frames = {n: numpy.maximum(mask, numpy.roll(mask, 1, 0)) for n, mask in masks.items()}
path = write("frames in bytes", in_bytes(more_frames))
many = len(frames_of(more_frames))
check("frames in bytes differ", 5 * many > (35 * many + 7) // 8 + 1, many)
compare("frames in bytes", path, grid, more_frames, 2, 7, "each of its frames begins with a byte of its own")
refused("neither", write("neither", in_bytes(more_frames, b"\0\0\0")), f"{many} frames", "export it again")
ds = make.seg(more_frames, grid)
ds.PixelData = make.padded(ds.PixelData) + b"\0\0"
refused("a little more", write("a little more", ds), "38 bytes of pixels, where its 8 frames take 35", "export it again")

# A frame that lies between the slices of the others does not make slices many times thinner.
column = numpy.zeros(make.SHAPE, numpy.uint8)
column[2:7, 1:4, 2:5] = 1


def moved(name, off, **how):
    ds = make.seg({1: column}, grid, **how)
    ds.PerFrameFunctionalGroupsSequence[2].PlanePositionSequence[0].ImagePositionPatient = [make.number(v) for v in grid.position(4 + off / make.STEP)]
    return write(name, ds)


for off in (0.5, 0.75, 1.0, 1.25):
    refused(f"off by {off}", moved(f"off by {off}", off), "slices lie 2.50 mm apart", "frame 3", f"{off:.2f} mm off", "export it again")
    if off != 1.25:  # a gap shows this step
        refused(f"off by {off} of a thickness", moved(f"thick {off}", off, spacing=None), "slices of 2.50 mm", "frame 3")
compare("off by little", moved("off by little", 0.03), grid, {1: column}, 2, 6)
# Where all frames lie nearer to one another than the file says, it is the file that errs.
compare("nearer", write("nearer", make.seg({1: column}, grid, spacing=5, thickness=None)), grid, {1: column}, 2, 6, "says that its slices lie 5.00 mm")
compare("nearer than thick", write("nearer than thick", make.seg({1: column}, grid, spacing=None, thickness=5)), grid, {1: column}, 2, 6)

# A part of a segmentation is not the whole; one of a single part is.
ds = make.seg(masks, grid)
ds.ConcatenationUID, ds.InConcatenationNumber, ds.InConcatenationTotalNumber, ds.ConcatenationFrameOffsetNumber = make.SERIES + ".901", 1, 2, 0
refused("a part", write("a part", ds), "is part 1 of 2 of a segmentation", "concatenation", "as one file")
del ds.InConcatenationTotalNumber
refused("a part of an unknown number", write("a part of ?", ds), "is part 1 of ? of a segmentation")
ds.InConcatenationTotalNumber = 1
compare("the only part", write("the only part", ds), grid, masks, 2, 6)


# A segmentation that was drawn on slices that are no even stack: each slice of the grid has the nearest old frame.
def series_at(name, places):
    make.write_series(folder / name, grid)
    for k, place in enumerate(places):
        ds = pydicom.dcmread(folder / name / f"ct{k:03}.dcm")
        ds.ImagePositionPatient = [make.number(v) for v in place]
        ds.save_as(folder / name / f"ct{k:03}.dcm")
    return folder / name


def drawn_on(name, places, given, **how):
    ds = make.seg(given, grid, spacing=None, **how)
    for group in ds.PerFrameFunctionalGroupsSequence:
        place = group.PlanePositionSequence[0]
        k = round((float(place.ImagePositionPatient[2]) - grid.origin[2]) / make.STEP)
        place.ImagePositionPatient = [make.number(v) for v in places[k]]
    return write(name, ds)


def resampled(name, path, ct, *words):
    out = folder / "resampled.seg.nrrd"
    out.unlink(missing_ok=True)
    ran = run("convert", path, out, "--like", ct, "--resample")
    check(name + " says", all(w in ran.stderr for w in words), ran.stderr)
    return read_nrrd(out) if out.exists() else (numpy.zeros((1, 1, 1, 1)), None, None, {})


over = {1: masks[1], 2: numpy.maximum(masks[2], masks[1])}
heights = [0, 2, 4, 6, 8, 10, 13, 16, 19]
for like in ("highdicom", "dcmqi"):
    # 1.5 mm are two rows; the last slice lies 16 rows beside the first.
    places = [grid.origin + [0, 1.5 * k, 2.5 * k] for k in range(9)]
    ct = series_at("tilted", places)
    path = drawn_on(f"on tilted {like}", places, masks, like=like)
    refused(f"tilted alone {like}", path, "shifted sideways", "--like, with --resample where that is tilted")
    voxels = resampled(f"tilted {like}", path, ct, "was drawn on slices that were resampled", "nearest to it, up to 0.00 mm away")[0][0]
    wanted = numpy.zeros((9, 21, 7), numpy.uint8)
    for k in range(9):
        wanted[k, 2 * k:2 * k + 5] = labels[k]
    check(f"tilted {like}", voxels.shape == wanted.shape and numpy.array_equal(voxels, wanted), voxels.shape)
    voxels, _, _, segments = resampled(f"tilted layers {like}", drawn_on(f"layers on tilted {like}", places, over, like=like), ct, "layers")
    for n in segments and over:
        layer, value, _ = segments[make.NAMES[n]]
        check(f"tilted layers {like} {n}", (voxels[layer] == value).sum() == over[n].sum(), n)
    # Unevenly spaced: 12 and 14 mm lie nearest to 13, and 18 to 19.
    places = [grid.origin + [0, 0, z] for z in heights]
    ct = series_at("uneven", places)
    tall = {1: masks[1].copy()}
    tall[1][8, 2, 2:5] = 1
    voxels = resampled(f"uneven {like}", drawn_on(f"on uneven {like}", places, tall, like=like), ct, "up to 1.00 mm away")[0][0]
    wanted = numpy.stack([tall[1][k] for k in (0, 1, 2, 3, 4, 5, 6, 6, 7, 8)])
    check(f"uneven {like}", numpy.array_equal(voxels, wanted), numpy.argwhere(voxels)[:9])

# What is written on the new grid is read on it.
source = folder / "t.seg.nrrd"
ct = folder / "tilted"
run("convert", folder / "on tilted dcmqi" / "seg.dcm", source, "--like", ct, "--resample")
run("convert", source, folder / "again.dcm", "--like", ct, "--resample")
voxels = resampled("written again", folder / "again.dcm", ct)[0]
check("written again", source.exists() and numpy.array_equal(voxels, read_nrrd(source)[0]), voxels.shape)

# Contours that refer to the image of another slice lie where they say, and that is said; twice is twice all the same.
square = [(0.6, 0.6), (4.4, 0.6), (4.4, 3.4), (0.6, 3.4)]
ct = folder / "straight"
make.write_series(ct, grid)
box = numpy.zeros(make.SHAPE)
box[2:4, 1:4, 1:5] = 1
for name, images, words in (("own images", (2, 3, 3), None),
                            ("other images", (3, 4, 4), "has 2 contours that refer to the image of another slice than the one they lie on "
                                                        "(the first lies on slice 3 of its series and refers to the image of slice 4); "
                                                        "their places were taken"),
                            ("one other image", (2, 4, 3), "has 1 contour that refers to the image of another slice")):
    ds = make.rtstruct({1: ("A", [("CLOSED_PLANAR", make.on_plane(grid, k, square)) for k in (2, 3, 3)])})
    for contour, k in zip(ds.ROIContourSequence[0].ContourSequence, images):
        contour.ContourImageSequence = pydicom.Sequence([make.item(ReferencedSOPClassUID=make.CT, ReferencedSOPInstanceUID=f"{make.SERIES}.{k + 1}")])
    out = folder / "contours.seg.nrrd"
    out.unlink(missing_ok=True)
    ran = run("convert", write(name, ds), out, "--like", ct)
    check(name + " says", (words in ran.stderr) if words else "refer" not in ran.stderr, ran.stderr)
    check(name + " twice", "1 contour twice" in ran.stderr, ran.stderr)
    check(name, out.exists() and numpy.array_equal(read_nrrd(out)[0][0], box), ran.stderr)

finish()
