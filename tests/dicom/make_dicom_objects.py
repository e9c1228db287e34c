#!/usr/bin/python3
"""DICOM segmentations and contours as programs of the field write them, with voxels and places that are known.

dicom_objects_test.py compares what Homolog reads of them. Needs python3-pydicom and python3-numpy.
"""
import copy

import numpy
from pydicom.dataset import Dataset, FileMetaDataset
from pydicom.encaps import encapsulate
from pydicom.sequence import Sequence
from pydicom.uid import DeflatedExplicitVRLittleEndian, ExplicitVRLittleEndian, ImplicitVRLittleEndian, RLELossless

SPACE, SERIES, STUDY = "1.2.826.0.1.3680043.9.1", "1.2.826.0.1.3680043.9.2", "1.2.826.0.1.3680043.9.3"
CT, SEG, LABELS, CONTOURS = ("1.2.840.10008.5.1.4.1.1." + end for end in ("2", "66.4", "66.7", "481.3"))
SHAPE = (9, 5, 7)  # slices, rows, columns: a frame of 35 bits ends within a byte
SPACING = (0.75, 0.5)  # between rows, between columns
STEP = 2.5


def axes(oblique):
    """Unit directions of columns, rows and slices."""
    if not oblique:
        return numpy.eye(3)
    a, b, c = 0.3, -0.2, 0.4
    x = numpy.array([[1, 0, 0], [0, numpy.cos(a), -numpy.sin(a)], [0, numpy.sin(a), numpy.cos(a)]])
    y = numpy.array([[numpy.cos(b), 0, numpy.sin(b)], [0, 1, 0], [-numpy.sin(b), 0, numpy.cos(b)]])
    z = numpy.array([[numpy.cos(c), -numpy.sin(c), 0], [numpy.sin(c), numpy.cos(c), 0], [0, 0, 1]])
    return (x @ y @ z).T


def number(value):
    """A decimal string of at most 16 characters."""
    text = repr(round(float(value), 9))
    return text if len(text) <= 16 else f"{value:.10g}"[:16]


class Grid:
    """Where the voxels of an array (slices, rows, columns) lie."""

    def __init__(self, oblique=False, origin=(-31.25, 12.5, 100.0), step=STEP):
        self.axes, self.origin, self.step = axes(oblique), numpy.array(origin), step

    def position(self, k):
        return self.origin + k * self.step * self.axes[2]


def item(**values):
    one = Dataset()
    for key, value in values.items():
        setattr(one, key, value)
    return one


def code(value, meaning):
    return item(CodeValue=value, CodingSchemeDesignator="SCT", CodeMeaning=meaning)


def basis(storage, modality, uid):
    ds = item(SOPClassUID=storage, SOPInstanceUID=uid, Modality=modality, StudyInstanceUID=STUDY, PatientID="p",
              PatientName="Phantom^One", StudyID="1", StudyDate="20240102", StudyTime="101500", SeriesNumber=1,
              InstanceNumber=1, SpecificCharacterSet="ISO_IR 192", FrameOfReferenceUID=SPACE)
    ds.file_meta = FileMetaDataset()
    ds.file_meta.MediaStorageSOPClassUID = storage
    ds.file_meta.MediaStorageSOPInstanceUID = uid
    ds.file_meta.TransferSyntaxUID = ExplicitVRLittleEndian
    return ds


def save(ds, path, syntax=ExplicitVRLittleEndian):
    ds.file_meta.TransferSyntaxUID = syntax
    ds.is_little_endian, ds.is_implicit_VR = True, syntax == ImplicitVRLittleEndian
    path.parent.mkdir(parents=True, exist_ok=True)
    ds.save_as(str(path), write_like_original=False)


def save_encoded(ds, path, syntax):
    """Saves encoded pixels in a transfer syntax that pydicom need not know."""
    save(ds, path, RLELossless)
    data = path.read_bytes()
    uid = padded(syntax.encode())
    begin = data.index(b"\2\0\x10\0UI")
    length = int.from_bytes(data[begin + 6:begin + 8], "little")
    group = int.from_bytes(data[140:144], "little") + len(uid) - length
    path.write_bytes(data[:140] + group.to_bytes(4, "little") + data[144:begin + 6] + len(uid).to_bytes(2, "little") + uid +
                     data[begin + 8 + length:])


def write_series(folder, grid, shape=SHAPE):
    """The CT that all objects refer to."""
    for k in range(shape[0]):
        ds = basis(CT, "CT", f"{SERIES}.{k + 1}")
        ds.SeriesInstanceUID, ds.InstanceNumber = SERIES, k + 1
        ds.ImagePositionPatient = [number(v) for v in grid.position(k)]
        ds.ImageOrientationPatient = [number(v) for v in grid.axes[:2].ravel()]
        ds.PixelSpacing, ds.SliceThickness = [number(v) for v in SPACING], number(grid.step)
        ds.Rows, ds.Columns, ds.SamplesPerPixel, ds.PhotometricInterpretation = shape[1], shape[2], 1, "MONOCHROME2"
        ds.BitsAllocated, ds.BitsStored, ds.HighBit, ds.PixelRepresentation = 16, 16, 15, 1
        ds.RescaleSlope, ds.RescaleIntercept = 1, 0
        ds.PixelData = numpy.full(shape[1:], 10 * k, numpy.int16).tobytes()
        save(ds, folder / f"ct{k:03}.dcm")


RAMP = numpy.array([3.0, -2.0, 4.0])


def ramp(places):
    """A value that grows evenly in space."""
    return 1000 + places @ RAMP


def write_ramp(folder, grid, places):
    """Slices of 9 × 8 pixels at places along the axes of a grid, which hold the ramp, to 1e-5."""
    for k, place in enumerate(places):
        ds = basis(CT, "CT", f"{SERIES}.{k + 1}")
        ds.SeriesInstanceUID, ds.InstanceNumber = SERIES, k + 1
        at = grid.origin + numpy.array(place) @ grid.axes
        ds.ImagePositionPatient = [number(v) for v in at]
        ds.ImageOrientationPatient = [number(v) for v in grid.axes[:2].ravel()]
        ds.PixelSpacing, ds.SliceThickness = [number(v) for v in SPACING], number(grid.step)
        ds.Rows, ds.Columns, ds.SamplesPerPixel, ds.PhotometricInterpretation = 9, 8, 1, "MONOCHROME2"
        j, i = numpy.indices((9, 8))
        values = ramp(at + i[..., None] * SPACING[1] * grid.axes[0] + j[..., None] * SPACING[0] * grid.axes[1])
        ds.BitsAllocated, ds.BitsStored, ds.HighBit, ds.PixelRepresentation = 32, 32, 31, 1
        ds.RescaleSlope, ds.RescaleIntercept = "1e-6", 0
        ds.PixelData = numpy.rint(values * 1e6).astype("<i4").tobytes()
        save(ds, folder / f"ct{k:03}.dcm")


def lab(l, a, b):
    return [round(l / 100 * 65535), round((a + 128) / 255 * 65535), round((b + 128) / 255 * 65535)]


NAMES = {1: "Liver", 2: "Kidney, left", 3: "Größe", 4: "empty"}


def segment(n, kind="BINARY"):
    one = item(SegmentNumber=n, SegmentLabel=NAMES.get(n, f"Segment {n}"), SegmentAlgorithmType="MANUAL",
               SegmentedPropertyCategoryCodeSequence=Sequence([code("123037004", "Anatomical Structure")]),
               SegmentedPropertyTypeCodeSequence=Sequence([code("10200004", "Liver")]))
    if kind != "LABELMAP":
        one.RecommendedDisplayCIELabValue = lab(53.24, 80.09, 67.2)  # sRGB red, by D65
    return one


def seg(masks, grid, kind="BINARY", like="highdicom", spacing=STEP, thickness=STEP, keep_empty=False, numbers=None,
        full=255, order=1):
    """A segmentation of `masks` {number: array}; of LABELMAP one array of labels under the key 0.

    like: "highdicom" shares direction and pixel measures; "dcmqi" gives the derivation and the frame's content too;
    "each" repeats all of them in every frame, as some converters do.
    """
    first = next(iter(masks.values()))
    storage = LABELS if kind == "LABELMAP" else SEG
    ds = basis(storage, "SEG", f"{SERIES}.900")
    ds.SeriesInstanceUID, ds.ImageType = f"{SERIES}.9", ["DERIVED", "PRIMARY"]
    ds.Rows, ds.Columns, ds.SamplesPerPixel, ds.PhotometricInterpretation = *first.shape[1:], 1, "MONOCHROME2"
    bits = {"BINARY": 1, "FRACTIONAL": 8, "LABELMAP": 8 * first.dtype.itemsize}[kind]
    ds.BitsAllocated, ds.BitsStored, ds.HighBit, ds.PixelRepresentation = bits, bits, bits - 1, 0
    ds.LossyImageCompression, ds.SegmentationType, ds.ContentLabel = "00", kind, "SEGMENTATION"
    if kind == "FRACTIONAL":
        ds.SegmentationFractionalType, ds.MaximumFractionalValue = "PROBABILITY", full
    ds.SegmentSequence = Sequence([segment(n, kind) for n in (numbers or sorted(masks))])
    ds.ReferencedSeriesSequence = Sequence([item(
        SeriesInstanceUID=SERIES, ReferencedInstanceSequence=Sequence(
            [item(ReferencedSOPClassUID=CT, ReferencedSOPInstanceUID=f"{SERIES}.{k + 1}") for k in range(len(first))]))])
    ds.DimensionOrganizationSequence = Sequence([item(DimensionOrganizationUID=f"{SERIES}.77")])
    measures = item(PixelSpacing=[number(v) for v in SPACING])
    if thickness:
        measures.SliceThickness = number(thickness)
    if spacing:
        measures.SpacingBetweenSlices = number(spacing)
    direction = item(ImageOrientationPatient=[number(v) for v in grid.axes[:2].ravel()])
    shared = item()
    if like != "each":
        shared.PlaneOrientationSequence, shared.PixelMeasuresSequence = Sequence([direction]), Sequence([measures])
    ds.SharedFunctionalGroupsSequence = Sequence([shared])
    groups, frames = [], []
    for n in sorted(masks):
        for k in range(len(first))[::order]:
            if not (keep_empty or masks[n][k].any()):
                continue
            group = item(PlanePositionSequence=Sequence(
                [item(ImagePositionPatient=[number(v) for v in grid.position(k)])]))
            if kind != "LABELMAP":
                group.SegmentIdentificationSequence = Sequence([item(ReferencedSegmentNumber=n)])
            if like != "highdicom":
                group.FrameContentSequence = Sequence([item(DimensionIndexValues=[n, k + 1])])
                group.DerivationImageSequence = Sequence([item(SourceImageSequence=Sequence(
                    [item(ReferencedSOPClassUID=CT, ReferencedSOPInstanceUID=f"{SERIES}.{k + 1}")]))])
            if like == "each":
                group.PlaneOrientationSequence = Sequence([copy.deepcopy(direction)])
                group.PixelMeasuresSequence = Sequence([copy.deepcopy(measures)])
            groups.append(group)
            frames.append(masks[n][k])
    ds.PerFrameFunctionalGroupsSequence, ds.NumberOfFrames = Sequence(groups), len(frames)
    pixels = numpy.stack(frames) if frames else numpy.zeros((0, *first.shape[1:]), first.dtype)
    ds.PixelData = padded(numpy.packbits(pixels.ravel() > 0, bitorder="little").tobytes() if bits == 1 else pixels.tobytes())
    ds["PixelData"].VR = "OB" if bits <= 8 else "OW"
    return ds


def padded(data):
    return data + b"\0" * (len(data) % 2)


def run_lengths(plane):
    """A plane of bytes in DICOM's run-length encoding, as literal runs alone."""
    data, out = plane.tobytes(), b""
    for begin in range(0, len(data), 128):
        run = data[begin:begin + 128]
        out += bytes([len(run) - 1]) + run
    head = (1).to_bytes(4, "little") + (64).to_bytes(4, "little")
    return padded(head.ljust(64, b"\0") + out)


def encode(ds, frames):
    ds.PixelData = encapsulate(frames)
    ds["PixelData"].is_undefined_length = True
    ds["PixelData"].VR = "OB"


def blobs():
    """Two structures beside one another with gaps: slices 2 and 6 alone hold the first, 3 the second."""
    one, two = numpy.zeros(SHAPE, numpy.uint8), numpy.zeros(SHAPE, numpy.uint8)
    one[2, 1:4, 2:6], one[6, 0, 0], one[6, 4, 6] = 1, 1, 1
    two[3, 2, 1:4], two[6, 2:4, 3] = 1, 1
    return {1: one, 2: two}


def rtstruct(rois, points=None):
    """A structure set. rois {number: (name, [(type, points in mm)])}."""
    ds = basis(CONTOURS, "RTSTRUCT", f"{SERIES}.800")
    del ds.FrameOfReferenceUID  # a structure set has none of its own
    ds.SeriesInstanceUID, ds.StructureSetLabel = f"{SERIES}.8", "RTSTRUCT"
    series = item(SeriesInstanceUID=SERIES, ContourImageSequence=Sequence(
        [item(ReferencedSOPClassUID=CT, ReferencedSOPInstanceUID=f"{SERIES}.{k + 1}") for k in range(SHAPE[0])]))
    study = item(ReferencedSOPClassUID="1.2.840.10008.3.1.2.3.1", ReferencedSOPInstanceUID=STUDY,
                 RTReferencedSeriesSequence=Sequence([series]))
    ds.ReferencedFrameOfReferenceSequence = Sequence(
        [item(FrameOfReferenceUID=SPACE, RTReferencedStudySequence=Sequence([study]))])
    ds.StructureSetROISequence = Sequence(
        [item(ROINumber=n, ReferencedFrameOfReferenceUID=SPACE, ROIName=name, ROIGenerationAlgorithm="MANUAL")
         for n, (name, _) in rois.items()])
    ds.ROIContourSequence = Sequence([item(ROIDisplayColor=[255, 128, 0], ReferencedROINumber=n, ContourSequence=Sequence(
        [item(ContourGeometricType=kind, NumberOfContourPoints=len(places),
              ContourData=[number(v) for place in places for v in place]) for kind, places in drawn]))
        for n, (_, drawn) in rois.items()])
    ds.RTROIObservationsSequence = Sequence([item(ObservationNumber=n, ReferencedROINumber=n, RTROIInterpretedType="ORGAN",
                                                  ROIInterpreter="") for n in rois])
    return ds


def on_plane(grid, k, corners):
    """Corners in voxels (column, row) of slice k, in mm."""
    return [grid.position(k) + SPACING[1] * i * grid.axes[0] + SPACING[0] * j * grid.axes[1] for i, j in corners]
