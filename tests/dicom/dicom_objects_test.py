#!/usr/bin/python3
"""What Homolog reads of DICOM segmentations and contours, and writes, is what was put in: values equal, places to 1e-3 mm.

dicom_objects_test.py PROGRAM. Exits with 77 where pydicom or numpy is missing.
"""
import json, zlib

from checks import check, compare, compare_on, finish, folder, make, numpy, pydicom, read_nrrd, refused, run, write



def zlib_raw(data):
    packer = zlib.compressobj(9, zlib.DEFLATED, -15)
    return packer.compress(data) + packer.flush()


masks = make.blobs()
for oblique in (False, True):
    grid = make.Grid(oblique)
    kind = "oblique" if oblique else "straight"
    for like in ("highdicom", "dcmqi", "each"):
        name = f"{like} {kind}"
        compare(name, write(name, make.seg(masks, grid, like=like)), grid, masks, 2, 6)
    for syntax in (make.ImplicitVRLittleEndian, make.DeflatedExplicitVRLittleEndian):
        name = f"{kind} {syntax.name}"
        compare(name, write(name, make.seg(masks, grid), syntax), grid, masks, 2, 6)
    name = f"whole {kind}"
    compare(name, write(name, make.seg(masks, grid, keep_empty=True, order=-1)), grid, masks)
    name = f"without a distance {kind}"  # the gaps of 2.5 and 7.5 mm tell it
    compare(name, write(name, make.seg(masks, grid, spacing=None, thickness=None)), grid, masks, 2, 6, "2.50 mm, of which")
    name = f"thickness alone {kind}"  # its two frames lie 10 mm apart
    compare(name, write(name, make.seg({1: masks[1]}, grid, spacing=None)), grid, {1: masks[1]}, 2, 6, "thickness")
    name = f"wrong distance {kind}"
    compare(name, write(name, make.seg(masks, grid, spacing=4.1, thickness=None)), grid, masks, 2, 6, "says that its slices")
    name = f"beside its series {kind}"
    path = write(name, make.seg({1: masks[1]}, grid, spacing=None, thickness=1))
    make.write_series(path.parent, grid)
    compare(name, path, grid, {1: masks[1]})
    told = json.loads(run("info", "--json", path.parent).stdout or "{}")
    check(name + ": the folder is the CT", told.get("modality") == "CT" and told.get("dims") == list(make.SHAPE[::-1]), told)

    # On the grid of its series, from elsewhere; of other images of the same space; what was converted before.
    ct = path.parent
    compare_on(f"like {kind}", write(f"like {kind}", make.seg(masks, grid)), grid, masks, ct)
    compare_on(f"like without a distance {kind}", write(f"like {kind}", make.seg({1: masks[1]}, grid, spacing=None, thickness=None)),
               grid, {1: masks[1]}, ct)
    run("convert", folder / f"highdicom {kind}" / "seg.dcm", folder / "before.seg.nrrd")
    compare_on(f"converted before {kind}", folder / "before.seg.nrrd", grid, masks, ct)
    ds = make.seg(masks, grid)
    ds.ReferencedSeriesSequence[0].SeriesInstanceUID = make.SERIES + ".5"
    compare_on(f"of another series {kind}", write(f"other series {kind}", ds), grid, masks, ct, f"refers to the series {make.SERIES}.5")
    ds = make.seg(masks, grid)
    ds.ReferencedSeriesSequence[0].ReferencedInstanceSequence[3].ReferencedSOPInstanceUID += ".7"
    compare_on(f"of a missing image {kind}", write(f"missing {kind}", ds), grid, masks, ct, "refers to 9 images, 1 of which is not in")

    # Segments that overlap.
    over = {n: m.copy() for n, m in masks.items()}
    over[3] = masks[1] | masks[2]
    over[3][4] = 1
    compare(f"overlap {kind}", write(f"overlap {kind}", make.seg(over, grid)), grid, over, 2, 6, "overlap")

    # Label maps, of bytes and of words, with numbers that jump.
    for dtype, second in ((numpy.uint8, 2), (numpy.uint16, 3)):
        labels = (masks[1] + second * masks[2]).astype(dtype)
        name = f"label map {kind} {dtype.__name__}"
        path = write(name, make.seg({0: labels}, grid, "LABELMAP", numbers=[1, second]))
        compare(name, path, grid, {1: labels == 1, second: labels == second}, 2, 6)
    ds = make.seg({0: labels}, grid, "LABELMAP", numbers=[1, 3])
    ds.PhotometricInterpretation = "PALETTE COLOR"
    for colour, entries in zip(("Red", "Green", "Blue"), ((0, 255, 0, 0), (0, 0, 0, 128), (0, 0, 0, 255))):
        setattr(ds, colour + "PaletteColorLookupTableDescriptor", [4, 0, 8])
        setattr(ds, colour + "PaletteColorLookupTableData", bytes(entries))
    path = write(f"palette {kind}", ds)
    compare(f"palette {kind}", path, grid, {1: labels == 1, 3: labels == 3}, 2, 6)
    told = json.loads(run("info", "--json", path).stdout or "{}")
    check("palette's colours", [one["colour"] for one in told.get("labels", [])] == ["#ff0000", "#0080ff"], told)

# What `info` lists: numbers, names in UTF-8, colours from CIELab, segments without voxels.
path = write("names", make.seg({1: masks[1], 3: masks[2]}, make.Grid(), numbers=[1, 3, 4]))
told = json.loads(run("info", "--json", path).stdout or "{}")
listed = [(one["value"], one["name"], one["voxels"], one["colour"]) for one in told.get("labels", [])]
check("info", listed[:2] == [(1, "Liver", 14, "#ff0000"), (3, "Größe", 5, "#ff0000")], listed)
check("info of an empty segment", listed[2:] == [(4, "empty", 0, "#ff0000")], listed)

# Fractional: one, run-length encoded too, and several.
grid = make.Grid(True)
shares = numpy.zeros(make.SHAPE, numpy.uint8)
shares[2], shares[5] = numpy.arange(35).reshape(5, 7) * 7, 200
for name, syntax in (("fractional", make.ExplicitVRLittleEndian), ("fractional RLE", make.RLELossless)):
    ds = make.seg({1: shares}, grid, "FRACTIONAL", full=250)
    if syntax == make.RLELossless:
        make.encode(ds, [make.run_lengths(shares[2]), make.run_lengths(shares[5])])
    path, out = write(name, ds, syntax), folder / "share.nrrd"
    run("convert", path, out)
    voxels = read_nrrd(out)[0][0]
    check(name, voxels.dtype == numpy.dtype("<f4") and numpy.abs(voxels - shares[2:6] / 250).max() < 1e-6, voxels)
path = write("two fractions", make.seg({1: shares, 2: shares[::-1]}, grid, "FRACTIONAL"))
told = json.loads(run("info", "--json", path).stdout or "{}")
check("two fractions", told.get("layers") == 2 and told.get("voxel") == "float32", told)

# Frames each deflated by itself begin bytes of their own.
ds = make.seg(masks, grid)
frames = [numpy.packbits((m[k] > 0).ravel(), bitorder="little").tobytes() for m in masks.values() for k in range(9) if m[k].any()]
squeezed = [make.padded(zlib_raw(f)) for f in frames]
make.encode(ds, squeezed)
compare("deflated frames", write("deflated frames", ds, "1.2.840.10008.1.2.8.1"), grid, masks, 2, 6)

# What is refused.
def broken(name, change, *words, syntax=make.ExplicitVRLittleEndian, **how):
    ds = make.seg(masks, make.Grid(), **how)
    change(ds)
    refused(name, write(name, ds, syntax), *words)


def without(*keys):
    def change(ds):
        for key in keys:
            del ds[key]
    return change


broken("no frame of reference", without("FrameOfReferenceUID"), "frame of reference", "export it again")
broken("no such segment", lambda ds: ds.SegmentSequence.pop(), "segment 2", "does not describe")
broken("no place", lambda ds: ds.PerFrameFunctionalGroupsSequence[1].__delitem__("PlanePositionSequence"), "frame 2", "position")
broken("no direction", lambda ds: ds.SharedFunctionalGroupsSequence[0].__delitem__("PlaneOrientationSequence"), "direction")
broken("twice", lambda ds: setattr(ds.PerFrameFunctionalGroupsSequence[1].PlanePositionSequence[0], "ImagePositionPatient",
       ds.PerFrameFunctionalGroupsSequence[0].PlanePositionSequence[0].ImagePositionPatient), "two frames", "segment 1")
broken("to the side", lambda ds: setattr(ds.PerFrameFunctionalGroupsSequence[1].PlanePositionSequence[0],
       "ImagePositionPatient", [-30, 12.5, 115]), "sideways", "straight")
broken("uneven", lambda ds: setattr(ds.PerFrameFunctionalGroupsSequence[2].PlanePositionSequence[0],
       "ImagePositionPatient", ["-31.25", "12.5", "107.837"]), "even slices")
broken("more groups", lambda ds: ds.PerFrameFunctionalGroupsSequence.append(ds.PerFrameFunctionalGroupsSequence[0]),
       "has 4 frames and describes 5")
broken("fewer groups", lambda ds: ds.PerFrameFunctionalGroupsSequence.pop(), "has 4 frames and describes 3")
broken("more pixels", lambda ds: setattr(ds, "PixelData", ds.PixelData + bytes(10)), "has 4 frames, and has the pixels of")
broken("cut", lambda ds: setattr(ds, "PixelData", ds.PixelData[:10]), "cut short")
broken("unknown kind", lambda ds: setattr(ds, "SegmentationType", "SURFACE"), "SURFACE")
broken("unknown syntax", lambda ds: make.encode(ds, [b"\0" * 8] * 4), "1.2.840.10008.1.2.4.201", "uncompressed",
       syntax="1.2.840.10008.1.2.4.201")
path = write("line ends", make.seg(masks, make.Grid()))
path.write_bytes(path.read_bytes().replace(b"\n", b"\r\n"))
refused("line ends", path, "line ends", "copy it again")

# Contours: a ring by a keyhole and one by exclusive or, with a gap; a long one; a structure without points.
outer, inner = [(-0.5, -0.5), (5.5, -0.5), (5.5, 4.5), (-0.5, 4.5)], [(1.5, 0.5), (1.5, 3.5), (3.5, 3.5), (3.5, 0.5)]
keyhole = outer + outer[:1] + inner + inner[:1]
wanted = numpy.zeros(make.SHAPE, bool)
for k in (2, 3, 6):
    wanted[k, :, :6] = True
    wanted[k, 1:4, 2:4] = False
angles = numpy.linspace(0, 2 * numpy.pi, 4001)[:-1]
circle = [(3 + 2.2 * numpy.cos(a), 2 + 1.6 * numpy.sin(a)) for a in angles]
for oblique in (False, True):
    grid, kind = make.Grid(oblique), "oblique" if oblique else "straight"
    place = lambda k, corners: make.on_plane(grid, k, corners)  # noqa: E731
    drawn = {1: ("Liver", [("CLOSED_PLANAR", place(k, keyhole)) for k in (2, 3, 6)]),
             2: ("Kidney, left", [("CLOSEDPLANAR_XOR", place(k, c)) for k in (2, 3, 6) for c in (outer, inner)]),
             3: ("Größe", [("CLOSED_PLANAR", place(8, circle))]),
             5: ("isocentre", [("POINT", place(4, [(3, 2)]))]), 6: ("nothing", [])}
    series = folder / f"series {kind}"
    make.write_series(series, grid)
    for syntax in (make.ExplicitVRLittleEndian, make.ImplicitVRLittleEndian):
        path, out = write(f"contours {kind} {syntax.name}", make.rtstruct(drawn), syntax), folder / "rt.seg.nrrd"
        told = json.loads(run("info", "--json", path).stdout or "{}")
        rois = [(r["name"], r["number"], r["contours"], r["points"], r["planes"]) for r in told.get("rois", [])]
        check("info of contours", rois == [("Liver", 1, 3, 30, 3), ("Kidney, left", 2, 6, 24, 3), ("Größe", 3, 1, 4000, 1),
                                           ("isocentre", 5, 0, 1, 0), ("nothing", 6, 0, 0, 0)], rois)
        out.unlink(missing_ok=True)
        ran = run("convert", path, out, "--like", series)
        check("no points", "structure 6 (nothing)" in ran.stderr, ran.stderr)
        voxels, steps, origin, segments = read_nrrd(out)
        for name, n in (("Liver", 1), ("Kidney, left", 2)):
            layer, value, _ = segments[name]
            check(f"{name} {kind}", value == n and numpy.array_equal(voxels[layer] == n, wanted), numpy.argwhere((voxels[layer] == n) != wanted)[:5])
        layer, value, _ = segments["Größe"]
        j, i = numpy.mgrid[:5, :7]
        disc = ((i - 3) / 2.2) ** 2 + ((j - 2) / 1.6) ** 2 < 1
        check(f"circle {kind}", numpy.array_equal(voxels[layer][8] == 3, disc), voxels[layer][8])
        check("place", numpy.abs(origin - grid.position(0)).max() < 1e-3, origin)

ran = run("convert", path, folder / "one.nrrd", "--like", series, "--structure", "liver")
check("one structure", numpy.array_equal(read_nrrd(folder / "one.nrrd")[0][0] == 1, wanted) and "nothing" not in ran.stderr, ran.stderr)
ran = run("convert", path, folder / "no.nrrd", "--like", series, "--structure", "lever", status=1)
check("no such structure by name", "Liver" in ran.stderr, ran.stderr)

other = folder / "other"
make.SPACE, kept = make.SPACE + ".7", make.SPACE
make.write_series(other, make.Grid())
make.SPACE = kept
path = write("contours of another", make.rtstruct({1: ("Liver", [("CLOSED_PLANAR", make.on_plane(make.Grid(), 2, outer))])}))
ran = run("convert", path, folder / "no.seg.nrrd", "--like", other, status=1)
check("another scan", "another scan" in ran.stderr and "frames of reference" in ran.stderr, ran.stderr)
ran = run("convert", path, folder / "no.seg.nrrd", status=1)
check("without an image", "--like" in ran.stderr, ran.stderr)
ds = make.rtstruct({1: ("Liver", [])})
ds.ROIContourSequence[0].ReferencedROINumber = 7
refused("no such structure", write("no such structure", ds), "structure 7", "does not describe")

path = write("contours of another series", make.rtstruct({1: ("Liver", [("CLOSED_PLANAR", make.on_plane(make.Grid(), 2, outer))])}))
ds = pydicom.dcmread(path)
image = ds.ReferencedFrameOfReferenceSequence[0].RTReferencedStudySequence[0].RTReferencedSeriesSequence[0]
image.SeriesInstanceUID += ".5"
path = write("contours of another series", ds)
ran = run("convert", path, folder / "rt.seg.nrrd", "--like", folder / "series straight")
check("contours of another series", f"refers to the series {make.SERIES}.5" in ran.stderr, ran.stderr)

# Slices that are tilted or uneven are resampled where asked: a ramp stays one.
for name, places in (("tilted", [(0, 0.9 * k, 2.5 * k) for k in range(6)]), ("uneven", [(0, 0, z) for z in (0, 2, 4, 7, 9, 14)]),
                     ("both", [(0.3 * k, 0, z) for k, z in enumerate((0, 2, 4, 7, 9, 14))])):
    for oblique in (False, True):
        grid, ct, kind = make.Grid(oblique), folder / f"{name} {oblique}", f"{name} {'oblique' if oblique else 'straight'}"
        make.write_ramp(ct, grid, places)
        refused(kind + " without the option", ct, "--resample")
        out = folder / "ramp.nrrd"
        ran = run("convert", ct, out, "--resample", "--json")
        told = json.loads(ran.stdout or "{}").get("resampled", {})
        check(kind + " is said", "were resampled to a rectangular grid" in ran.stderr and told.get("from", {}).get("slices") == 6 and
              ("tilted" in told["why"] or "shifted" in told["why"]) == (name != "uneven"), (told, ran.stderr))
        voxels, steps, origin, _ = read_nrrd(out)
        k, j, i = numpy.indices(voxels[0].shape)
        at = origin + i[..., None] * steps[0] + j[..., None] * steps[1] + k[..., None] * steps[2]
        exact = make.ramp(at)
        filled = numpy.abs(voxels[0] - exact) < 1e-3
        check(kind + " ramp", numpy.all(filled | (voxels[0] == voxels[0].min())), voxels[0][~filled][:5])
        check(kind + " filled", filled.mean() > (0.99 if name == "uneven" else 0.3), filled.mean())
        check(kind + " steps", numpy.abs(numpy.linalg.norm(steps, axis=1) - [0.5, 0.75, 2.5 if name == "tilted" else 2]).max() < 1e-6, steps)
        check(kind + " info", "resampled" in json.loads(run("info", ct, "--resample", "--json").stdout or "{}"))
        # A segmentation of the resampled series lies where its voxels do, and refers to the series.
        drawn, seg = folder / f"drawn {kind}.seg.nrrd", folder / f"drawn {kind}.dcm"
        labels = numpy.zeros(voxels[0].shape, numpy.uint8)
        labels[1:4, 2:5, 3:6] = 1
        head = out.read_bytes().split(b"\n\n", 1)[0].replace(b"type: float", b"type: uint8").replace(b"encoding: gzip", b"encoding: raw")
        head = b"\n".join(line for line in head.split(b"\n") if not line.startswith(b"homolog"))
        drawn.write_bytes(head + b"\n\n" + labels.tobytes())
        ran = run("convert", drawn, seg, "--like", ct, "--resample")
        if not seg.exists():
            continue
        ds = pydicom.dcmread(seg)
        check(kind + " refers", len(ds.ReferencedSeriesSequence[0].ReferencedInstanceSequence) == 6 and ds.NumberOfFrames == 3 and
              "DerivationImageSequence" not in ds.PerFrameFunctionalGroupsSequence[0], ds.ReferencedSeriesSequence)
        run("convert", seg, folder / "back.seg.nrrd")
        back, steps_back, origin_back, _ = read_nrrd(folder / "back.seg.nrrd")
        check(kind + " back", numpy.array_equal(back[0], labels[1:4]), back.shape)
        check(kind + " back place", numpy.abs(origin_back - (origin + steps[2])).max() < 1e-3 and
              numpy.abs(steps_back - steps).max() < 1e-3, (origin_back, origin))
        run("convert", seg, folder / "on.seg.nrrd", "--like", ct, "--resample")
        check(kind + " on the grid", numpy.array_equal(read_nrrd(folder / "on.seg.nrrd")[0][0], labels))
        plain = run("convert", drawn, seg, "--like", ct, status=1)
        check(kind + " without the option, written", "--resample" in plain.stderr, plain.stderr)
        # A mesh as voxels of it: those whose centre is inside of a box around some of them.
        corners = [origin + (x, y, z) @ steps for x in (2.5, 5.5) for y in (1.5, 4.5) for z in (0.5, 3.5)]
        box = folder / "box.ply"
        box.write_text("ply\nformat ascii 1.0\ncomment SPACE=LPS\nelement vertex 8\nproperty double x\nproperty double y\nproperty double z\n"
                       "element face 6\nproperty list uchar int vertex_indices\nend_header\n" +
                       "".join(f"{x:.17g} {y:.17g} {z:.17g}\n" for x, y, z in corners) +
                       "4 0 1 3 2\n4 4 6 7 5\n4 0 4 5 1\n4 2 3 7 6\n4 0 2 6 4\n4 1 5 7 3\n")
        ran = run("label-map", box, "--like", ct, "--resample", "-o", seg, "--json")
        check(kind + " label-map", "resampled" in json.loads(ran.stdout or "{}"), ran.stderr)
        run("convert", seg, folder / "box.seg.nrrd", "--like", ct, "--resample")
        check(kind + " label-map on the grid", numpy.array_equal(read_nrrd(folder / "box.seg.nrrd")[0][0], labels))
        plain = run("label-map", box, "--like", ct, "-o", seg, status=1)
        check(kind + " label-map without the option", "--resample" in plain.stderr, plain.stderr)

# A series that was robbed of its UIDs is told all of them at once.
robbed = folder / "robbed"
make.write_series(robbed, make.Grid())
for file in robbed.glob("*.dcm"):
    ds = pydicom.dcmread(file)
    ds.StudyInstanceUID, ds.FrameOfReferenceUID = "", ""
    ds.save_as(file)
run("convert", folder / "straight Implicit VR Little Endian" / "seg.dcm", folder / "for robbed.seg.nrrd")
ran = run("convert", folder / "for robbed.seg.nrrd", folder / "robbed.dcm", "--like", robbed, status=1)
check("UIDs at once", "names no study and no frame of reference (their UIDs are missing)" in ran.stderr, ran.stderr)

# Written: segments that overlap, on the voxels of an oblique series, with its patient, its space and its images.
for oblique in (False, True):
    grid, kind = make.Grid(oblique), "oblique" if oblique else "straight"
    source, series = write(f"to write {kind}", make.seg(over, grid)), folder / f"series {kind}"
    run("convert", source, folder / "map.seg.nrrd")
    out, again = folder / f"written {kind}" / "seg.dcm", folder / f"written {kind}" / "again.dcm"
    out.parent.mkdir()
    for one in (out, again):
        run("convert", folder / "map.seg.nrrd", one, "--like", series)
    check("the same bytes", out.read_bytes() == again.read_bytes())
    again.unlink()
    compare(f"written {kind}", out, grid, over, 2, 6, "overlap")
    ds = pydicom.dcmread(out)
    check("written numbers", (ds.SOPClassUID, ds.Modality, ds.SegmentationType, ds.BitsAllocated) == (make.SEG, "SEG", "BINARY", 1), ds)
    check("written space", (ds.FrameOfReferenceUID, ds.StudyInstanceUID, str(ds.PatientName)) == (make.SPACE, make.STUDY, "Phantom^One"), ds)
    images = [one.ReferencedSOPInstanceUID for one in ds.ReferencedSeriesSequence[0].ReferencedInstanceSequence]
    check("written series", ds.ReferencedSeriesSequence[0].SeriesInstanceUID == make.SERIES and
          images == [f"{make.SERIES}.{k + 1}" for k in range(9)], images)
    bits = numpy.unpackbits(numpy.frombuffer(ds.PixelData, numpy.uint8), bitorder="little")[:ds.NumberOfFrames * 35].reshape(-1, 5, 7)
    held = [k for k in range(9) if any(mask[k].any() for mask in over.values())]  # counted from 1 without gaps
    for group, frame in zip(ds.PerFrameFunctionalGroupsSequence, bits):
        number, place = group.SegmentIdentificationSequence[0].ReferencedSegmentNumber, group.PlanePositionSequence[0].ImagePositionPatient
        image = group.DerivationImageSequence[0].SourceImageSequence[0].ReferencedSOPInstanceUID
        k = int(image.rsplit(".", 1)[1]) - 1
        check("written frame", numpy.array_equal(frame, over[number][k] > 0), (number, k))
        check("written place", numpy.abs(numpy.array(place, float) - grid.position(k)).max() < 1e-3, place)
        check("written index", list(group.FrameContentSequence[0].DimensionIndexValues) == [number, held.index(k) + 1], (number, k))
    check("every frame", ds.NumberOfFrames == sum(mask.any(axis=(1, 2)).sum() for mask in over.values()), ds.NumberOfFrames)
ran = run("convert", folder / "map.seg.nrrd", folder / "no.dcm", "--like", folder / "series straight", status=1)
check("another grid", "does not lie on the voxels" in ran.stderr and not (folder / "no.dcm").exists(), ran.stderr)
ran = run("convert", folder / "map.seg.nrrd", folder / "no.dcm", status=1)
check("no series", "--like" in ran.stderr, ran.stderr)


# Written: patient and study in whatever alphabet they are, as UTF-8; names in it are read, too.
ALPHABETS = (("ISO_IR 192", "Leber", "Yamada"), ("ISO_IR 144", "Почка", "Иванов^Иван"), ("ISO 2022 IR 100", "Größe", "Müller^Jörg"),
             ("GB18030", "肝脏", "王^小东"), (["", "ISO 2022 IR 87"], "肝臓", "Yamada^Tarou=山田^太郎"), ("ISO_IR 101", "ledvina", "Dvořák^Jan"),
             ("ISO_IR 148", "karaciğer", "Yıldız^Ali"), (["ISO 2022 IR 6", "ISO 2022 IR 100"], "rein", "Leclerc^Zoé"),
             (["", "ISO 2022 IR 149"], "간", "Hong^Gildong=洪^吉洞=홍^길동"))
grid = make.Grid()
for alphabet, organ, patient in ALPHABETS:
    name = " ".join([alphabet] if isinstance(alphabet, str) else alphabet)
    series = folder / f"series {name}"
    make.write_series(series, grid)
    for file in series.glob("*.dcm"):
        ds = pydicom.dcmread(file)
        ds.SpecificCharacterSet, ds.PatientName, ds.AccessionNumber, ds.PatientID = alphabet, patient, "ACC77", "PAT0123"
        ds.save_as(file)
    ds = make.seg(masks, grid)
    ds.SpecificCharacterSet, ds.PatientName, ds.SegmentSequence[0].SegmentLabel = alphabet, patient, organ
    path, out = write(f"names {name}", ds), folder / "alphabet.dcm"
    told = json.loads(run("info", "--json", path).stdout or "{}")
    check(f"names of {name}", [one["name"] for one in told.get("labels", [])][:1] == [organ], told)
    ran = run("convert", path, out, "--like", series)
    ds = pydicom.dcmread(out)
    check(f"patient of {name}", (str(ds.PatientName), ds.PatientID, ds.AccessionNumber, ds.StudyID) == (patient, "PAT0123", "ACC77", "1") and
          ds.SpecificCharacterSet == "ISO_IR 192" and "warning" not in ran.stderr, (ds.PatientName, ran.stderr))
    ds = make.rtstruct({1: (organ, [("CLOSED_PLANAR", make.on_plane(grid, 2, outer))])})
    ds.SpecificCharacterSet = alphabet
    told = json.loads(run("info", "--json", write(f"structures {name}", ds)).stdout or "{}")
    check(f"structures of {name}", [one["name"] for one in told.get("rois", [])] == [organ], told)
series = folder / "series ISO_IR 144"
for file in series.glob("*.dcm"):
    file.write_bytes(file.read_bytes().replace(b"ISO_IR 144", b"ISO_IR 999"))
ran = run("convert", path, out, "--like", series)
ds = pydicom.dcmread(out)
check("unknown letters", "lacks the patient's name" in ran.stderr and (str(ds.PatientName), ds.PatientID) == ("", "PAT0123"), ran.stderr)

# Written UIDs: others for another study, and for other names or colours; loss in compression goes on.
def uids(name, source, series):
    run("convert", source, folder / name, "--like", series)
    ds = pydicom.dcmread(folder / name)
    return ds.SOPInstanceUID, ds.SeriesInstanceUID, ds.DimensionOrganizationSequence[0].DimensionOrganizationUID


make.STUDY, make.SERIES, kept = make.STUDY + ".7", make.SERIES + ".7", (make.STUDY, make.SERIES)
make.write_series(folder / "second study", grid)
make.STUDY, make.SERIES = kept
run("convert", folder / "highdicom straight" / "seg.dcm", folder / "red.seg.nrrd")
(folder / "blue.seg.nrrd").write_bytes((folder / "red.seg.nrrd").read_bytes().replace(b"_Color:=1 0 0", b"_Color:=0 0 1"))
first = uids("red.dcm", folder / "red.seg.nrrd", folder / "series straight")
check("UIDs of another study", not set(first) & set(uids("second.dcm", folder / "red.seg.nrrd", folder / "second study")), first)
check("UID of other colours", first[0] != uids("blue.dcm", folder / "blue.seg.nrrd", folder / "series straight")[0], first)
check("UID of the same", first == uids("again.dcm", folder / "red.seg.nrrd", folder / "series straight"), first)
lossy = folder / "lossy"
make.write_series(lossy, grid)
ds = pydicom.dcmread(lossy / "ct004.dcm")
ds.LossyImageCompression, ds.LossyImageCompressionRatio, ds.LossyImageCompressionMethod = "01", "10", "ISO_10918_1"
ds.save_as(lossy / "ct004.dcm")
run("convert", folder / "red.seg.nrrd", out, "--like", lossy)
ds = pydicom.dcmread(out)
check("loss", (ds.LossyImageCompression, ds.LossyImageCompressionRatio, ds.LossyImageCompressionMethod) == ("01", 10, "ISO_10918_1"), ds)
check("no loss", pydicom.dcmread(folder / "red.dcm").LossyImageCompression == "00")

# Frames lie where the images of their series do, though their places are rounded or uneven by little.
rng = numpy.random.default_rng(1)
for name, oblique, step, placed in (("rounded thin", False, 0.625, lambda v: numpy.round(v, 1)), ("rounded", False, 1.25, lambda v: numpy.round(v, 1)),
                                    ("rounded oblique", True, 2.5, lambda v: numpy.round(v, 1)),
                                    ("uneven", False, 1.0, lambda v: numpy.round(v + [0, 0, rng.uniform(-.03, .03)], 4))):
    grid, series = make.Grid(oblique, step=step), folder / f"series {name}"
    make.write_series(series, grid)
    places = [placed(grid.position(k)) for k in range(9)]
    for k, place in enumerate(places):
        ds = pydicom.dcmread(series / f"ct{k:03}.dcm")
        ds.ImagePositionPatient = [make.number(v) for v in place]
        ds.save_as(series / f"ct{k:03}.dcm")
    ds = make.seg(masks, grid, spacing=step, thickness=step)
    for group in ds.PerFrameFunctionalGroupsSequence:
        place = group.PlanePositionSequence[0]
        k = round((numpy.array(place.ImagePositionPatient, float) - grid.position(0)) @ grid.axes[2] / step)
        place.ImagePositionPatient = [make.number(v) for v in places[k]]
    path = write(f"of {name}", ds)
    told = json.loads(run("info", "--json", path).stdout or "{}")
    check(f"alone {name}", told.get("dims") == [7, 5, 5], told)
    ran = run("convert", path, folder / "on.seg.nrrd", "--like", series)
    voxels, _, _, segments = read_nrrd(folder / "on.seg.nrrd")
    check(f"on its series {name}", all(numpy.array_equal(voxels[segments[make.NAMES[n]][0]] == n, mask > 0) for n, mask in masks.items()) and
          "warning" not in ran.stderr, ran.stderr)
    run("convert", folder / "on.seg.nrrd", out, "--like", series)
    off = 0
    for group in pydicom.dcmread(out).PerFrameFunctionalGroupsSequence:
        image = group.DerivationImageSequence[0].SourceImageSequence[0].ReferencedSOPInstanceUID
        place = numpy.array(group.PlanePositionSequence[0].ImagePositionPatient, float)
        off = max(off, numpy.abs(place - places[int(image.rsplit(".", 1)[1]) - 1]).max())
    check(f"at its images {name}", off < 1e-9, off)

# Every second slice: nothing says that there are others between.
grid = make.Grid()
path = write("every second", make.seg({1: numpy.where(numpy.arange(9)[:, None, None] % 2 == 0, over[1] | 1, 0).astype(numpy.uint8)}, grid, spacing=None))
ran = run("info", "--json", path)
check("every second slice", json.loads(ran.stdout or "{}").get("dims") == [7, 5, 5] and "2.50 mm thick" in ran.stderr, ran.stderr)

# Contours through the centres of voxels hold them, those around a hole too.
path = write("through centres", make.rtstruct({1: ("Liver", [("CLOSED_PLANAR", make.on_plane(grid, 2, [(1, 1), (4, 1), (4, 3), (1, 3)]))]),
    2: ("ring", [("CLOSEDPLANAR_XOR", make.on_plane(grid, 3, c)) for c in (outer, [(2, 1), (4, 1), (4, 3), (2, 3)])])}))
run("convert", path, folder / "edge.seg.nrrd", "--like", folder / "series straight")
voxels, _, _, segments = read_nrrd(folder / "edge.seg.nrrd")
wanted = numpy.zeros(make.SHAPE, bool)
wanted[2, 1:4, 1:5] = True
check("through centres", numpy.array_equal(voxels[segments["Liver"][0]] == 1, wanted), voxels[0][2])
wanted = numpy.zeros((5, 7), bool)
wanted[:, :6], wanted[2, 3] = True, False
check("around a hole", numpy.array_equal(voxels[segments["ring"][0]][3] == 2, wanted), voxels[segments["ring"][0]][3])

# A structure keeps what lies on slices; numbers may be 0.
path = write("one between", make.rtstruct({1: ("Liver", [("CLOSED_PLANAR", make.on_plane(grid, k, outer)) for k in (2, 3.4, 4)])}))
ran = run("convert", path, folder / "some.nrrd", "--like", folder / "series straight")
check("one between slices", "draws 1 of 3 contours of its structure 1 (Liver)" in ran.stderr and
      (read_nrrd(folder / "some.nrrd")[0][0] == 1).any(axis=(1, 2)).nonzero()[0].tolist() == [2, 4], ran.stderr)
path = write("number 0", make.rtstruct({0: ("GTV", [("CLOSED_PLANAR", make.on_plane(grid, 2, outer))]),
                                        1: ("GTV", [("CLOSED_PLANAR", make.on_plane(grid, 5, outer))])}))
run("convert", path, folder / "zero.nrrd", "--like", folder / "series straight", "--structure", "0")
check("structure 0", read_nrrd(folder / "zero.nrrd")[0][0][2].any() and not read_nrrd(folder / "zero.nrrd")[0][0][5].any())

# Fractional segments of one name are told apart by their numbers.
make.NAMES.update({5: "Lesion", 7: "Lesion"})
path = write("lesions", make.seg({5: shares, 7: shares[::-1]}, grid, "FRACTIONAL"))
told = json.loads(run("info", "--json", path).stdout or "{}")
check("names that tell apart", [one["name"] for one in told.get("labels", [])] == ["Lesion (segment 5)", "Lesion (segment 7)"], told)

# What other programs make of sequences that they do not know; large palettes; very many segments; line ends.
from pydicom.filebase import DicomBytesIO
from pydicom.filewriter import write_sequence


def unknown(ds, *tags):
    for tag in tags:
        bytes_of = DicomBytesIO()
        bytes_of.is_little_endian, bytes_of.is_implicit_VR = True, True
        write_sequence(bytes_of, ds[tag], ["utf8"])
        del ds[tag]
        pydicom.config.replace_un_with_known_vr = False
        ds.add_new(tag, "UN", bytes_of.getvalue())
    return ds


compare("unknown sequences", write("unknown", unknown(make.seg(masks, grid), 0x00620002, 0x52009230)), grid, masks, 2, 6)
told = json.loads(run("info", "--json", write("unknown contours", unknown(make.rtstruct({1: ("Liver", [("CLOSED_PLANAR", make.on_plane(grid, 2, outer))])}),
                                                                          0x30060039, 0x30060020))).stdout or "{}")
check("unknown contours", [(r["name"], r["points"]) for r in told.get("rois", [])] == [("Liver", 4)], told)
labels = (masks[1] + 2 * masks[2]).astype(numpy.uint16)
ds = make.seg({0: labels}, grid, "LABELMAP", numbers=[1, 2])
ds.PhotometricInterpretation = "PALETTE COLOR"
for colour, entries in zip(("Red", "Green", "Blue"), ((0xffff, 0), (0, 0x8000), (0, 0xffff))):
    table = numpy.zeros(65536, "<u2")
    table[1:3] = entries
    setattr(ds, colour + "PaletteColorLookupTableDescriptor", [0, 0, 16])
    setattr(ds, colour + "PaletteColorLookupTableData", table.tobytes())
told = json.loads(run("info", "--json", write("large palette", ds)).stdout or "{}")
check("large palette", [one["colour"] for one in told.get("labels", [])] == ["#ff0000", "#0080ff"], told)
refused("very many", write("very many", make.seg({0: labels}, grid, "LABELMAP", numbers=range(1, 16387))), "more than 16,384 segments")
for alphabet in ("ISO_IR 192", "ISO_IR 100", None):
    ds = make.rtstruct({1: ("Liver", [("CLOSED_PLANAR", make.on_plane(grid, 2, outer))])})
    if alphabet is None:
        del ds.SpecificCharacterSet
    else:
        ds.SpecificCharacterSet = alphabet
    path = write(f"line ends {alphabet}", ds)
    path.write_bytes(path.read_bytes().replace(b"\n", b"\r\n"))
    refused(f"line ends {alphabet}", path, "line ends", "copy it again")

# Fits: contours of two scans are none; all combined by exclusive or, or with keyholes, are as any others.
def ring(k, share=1.0):
    round_, width = numpy.linspace(0, 2 * numpy.pi, 61)[:-1], share * numpy.sqrt(1 - ((k - 4) / 5) ** 2)
    return [(3 + 60 * width * numpy.cos(a), 2 + 27 * width * numpy.sin(a)) for a in round_]


wide, fits = make.Grid(step=8), {}
for name, drawn in (("plain", [("CLOSED_PLANAR", ring(k)) for k in range(9)]), ("xor", [("CLOSEDPLANAR_XOR", ring(k)) for k in range(9)]),
                    ("apart", [("CLOSED_PLANAR", c) for k in range(9) for c in (ring(k), ring(k, 0.3)[::-1][-1:] + ring(k, 0.3)[::-1][:-1])]),
                    ("keyholes", [("CLOSED_PLANAR", ring(k) + ring(k)[:1] + ring(k, 0.3)[::-1][-1:] + ring(k, 0.3)[::-1]) for k in range(9)])):
    path = write(f"drawn {name}", make.rtstruct({1: ("organ", [(kind, make.on_plane(wide, k * 9 // len(drawn), c)) for k, (kind, c) in enumerate(drawn)])}))
    mesh = folder / f"{name}.vtk"
    ran = run("fit", "built-in:kidney", "--contours", path, "-o", mesh)
    check(f"{name} holes", ("rims of holes" in ran.stderr) == (name in ("apart", "keyholes")), ran.stderr)
    obj = folder / f"{name}.obj"
    run("convert", mesh, obj)
    fits[name] = numpy.array([line.split()[1:4] for line in obj.read_text().split("\n") if line.startswith("v ")], float)
check("fit by exclusive or", numpy.abs(fits["xor"] - fits["plain"]).max() < 1e-6, numpy.abs(fits["xor"] - fits["plain"]).max())
check("fit with keyholes", numpy.abs(fits["keyholes"] - fits["apart"]).max() < 1e-3, numpy.abs(fits["keyholes"] - fits["apart"]).max())
path = write("drawn elsewhere", pydicom.dcmread(folder / "drawn plain" / "seg.dcm"))
path.write_bytes(path.read_bytes().replace(make.SPACE.encode() + b"\0", make.SPACE[:-1].encode() + b"8\0"))
ran = run("fit", "built-in:kidney", "--contours", folder / "drawn plain" / "seg.dcm", path, "-o", folder / "no.ply", status=1)
check("two scans", "another scan" in ran.stderr and str(path) in ran.stderr, ran.stderr)

finish()
