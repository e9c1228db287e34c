#!/usr/bin/python3
"""DICOM objects that are whole only at first sight are read as they are meant, or said, or refused by name.

doubtful_objects_test.py PROGRAM. Exits with 77 where pydicom or numpy is missing.
"""
import copy

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

finish()
