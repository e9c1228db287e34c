#!/usr/bin/env python3
"""Makes the small files that fuzzing starts from: make_seeds.py PROGRAM OUT_FOLDER. They are kept in tests/fuzz/seeds."""

import pathlib
import struct
import subprocess
import sys
import zlib

program, out = sys.argv[1], pathlib.Path(sys.argv[2])


def put(reader, name, content):
    (out / reader).mkdir(parents=True, exist_ok=True)
    (out / reader / name).write_bytes(content if isinstance(content, bytes) else content.encode())


def convert(source, reader, name):
    (out / reader).mkdir(parents=True, exist_ok=True)
    subprocess.run([program, "convert", str(source), str(out / reader / name)], check=True, stdout=subprocess.DEVNULL)


voxels = bytes(range(24))
head = "ObjectType = Image\nNDims = 3\nDimSize = 4 3 2\nElementType = MET_UCHAR\nElementSpacing = 1 1 2\nOffset = 0 0 0\n"
put("mha", "plain.mha", head.encode() + b"ElementDataFile = LOCAL\n" + voxels)
packed = zlib.compress(voxels)
put("mha", "packed.mha", head.encode() + f"CompressedData = True\nCompressedDataSize = {len(packed)}\nElementDataFile = LOCAL\n".encode() + packed)
image = out / "mha/plain.mha"
convert(image, "nii", "a.nii")
convert(image, "niigz", "a.nii.gz")
convert(image, "nrrd", "a.nrrd")
put("nrrd", "text.nrrd", "NRRD0004\ntype: short\ndimension: 3\nsizes: 3 2 2\nencoding: text\nspacings: 1 1 1\n\n1 2 3 4 5 6\n7 8 9 10 11 12\n")
put("nrrd", "raw.nrrd", b"NRRD0004\ntype: uchar\ndimension: 3\nspace: left-posterior-superior\nsizes: 4 3 2\n"
    b"space directions: (1,0,0) (0,1,0) (0,0,1)\nspace origin: (0,0,0)\nencoding: raw\n\n" + voxels)


def element(group, number, kind, value):
    if len(value) % 2:
        value += b"\0" if kind == b"UI" else b" "
    size = struct.pack("<H", len(value)) if kind not in (b"OW", b"OB") else b"\0\0" + struct.pack("<I", len(value))
    return struct.pack("<HH", group, number) + kind + size + value


def dicom(syntax, pixels):
    meta = element(2, 0x10, b"UI", syntax)
    meta = element(2, 0, b"UL", struct.pack("<I", len(meta))) + meta
    body = element(8, 0x16, b"UI", b"1.2.840.10008.5.1.4.1.1.2") + element(8, 0x18, b"UI", b"1.2.3")
    body += element(8, 0x60, b"CS", b"CT") + element(0x18, 0x50, b"DS", b"1") + element(0x20, 0xE, b"UI", b"1.2")
    body += element(0x20, 0x32, b"DS", b"0\\0\\0") + element(0x20, 0x37, b"DS", b"1\\0\\0\\0\\1\\0")
    for number, value in ((2, 1), (0x10, 3), (0x11, 4)):
        body += element(0x28, number, b"US", struct.pack("<H", value))
        if number == 2:
            body += element(0x28, 4, b"CS", b"MONOCHROME2")
    body += element(0x28, 0x30, b"DS", b"1\\1")
    for number, value in ((0x100, 8), (0x101, 8), (0x102, 7), (0x103, 0)):
        body += element(0x28, number, b"US", struct.pack("<H", value))
    return b"\0" * 128 + b"DICM" + meta + body + pixels


put("dcm", "plain.dcm", dicom(b"1.2.840.10008.1.2.1", element(0x7FE0, 0x10, b"OW", voxels[:12])))
rle = struct.pack("<16I", 1, 64, *([0] * 14)) + bytes([11]) + voxels[:12] + b"\0"
item = lambda data: struct.pack("<HHI", 0xFFFE, 0xE000, len(data)) + data
put("dcm", "rle.dcm", dicom(b"1.2.840.10008.1.2.5", struct.pack("<HH", 0x7FE0, 0x10) + b"OB\0\0\xff\xff\xff\xff" + item(b"") + item(rle) +
                             struct.pack("<HHI", 0xFFFE, 0xE0DD, 0)))


def png(width, height, bits, colour, rows):
    def chunk(name, data):
        return struct.pack(">I", len(data)) + name + data + struct.pack(">I", zlib.crc32(name + data))

    return (b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", struct.pack(">IIBBBBB", width, height, bits, colour, 0, 0, 0)) +
            chunk(b"IDAT", zlib.compress(rows)) + chunk(b"IEND", b""))


put("png", "grey.png", png(4, 2, 8, 0, b"\0abcd\0efgh"))
put("png", "deep.png", png(2, 1, 16, 0, b"\0abcd"))
put("png", "colour.png", png(1, 1, 8, 6, b"\0abcd"))


def tiff(entries, data):
    table = struct.pack("<H", len(entries)) + b"".join(struct.pack("<HHII", *entry) for entry in entries) + b"\0\0\0\0"
    return b"II" + struct.pack("<HI", 42, 8 + len(data)) + data + table


def plain(compression, data):
    return tiff([(256, 4, 1, 4), (257, 4, 1, 2), (258, 3, 1, 8), (259, 3, 1, compression), (262, 3, 1, 1), (273, 4, 1, 8),
                 (278, 4, 1, 2), (279, 4, 1, len(data))], data)


put("tif", "plain.tif", plain(1, b"abcdefgh"))
put("tif", "zip.tif", plain(8, zlib.compress(b"abcdefgh")))
put("tif", "packbits.tif", plain(32773, bytes([7]) + b"abcdefgh"))

put("obj", "a.obj", "# SPACE=LPS\nv 1 0 0\nv -1 0 0\nv 0 1 0\nv 0 -1 0\nv 0 0 1\nv 0 0 -1\n"
    "f 1 3 5\nf 3 2 5\nf 2 4 5\nf 4 1 5\nf 3 1 6\nf 2 3 6\nf 4 2 6\nf 1 4 6\n")
for reader in ("ply", "vtk", "vtp", "stl", "particles"):
    convert(out / "obj/a.obj", reader, "a." + reader)
put("ply", "text.ply", 'ply\nformat ascii 1.0\ncomment SPACE=RAS\ncomment homolog.region {"name":"a","factor":2,"colour":"#112233"}\n'
    'comment homolog.landmark {"name":"l","position":[1,2,3]}\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n'
    "property uchar region\nelement face 1\nproperty list uchar int vertex_indices\nend_header\n0 0 0 1\n1 0 0 0\n0 1 0 1\n3 0 1 2\n")
put("vtk", "text.vtk", "# vtk DataFile Version 3.0\nSPACE=LPS\nASCII\nDATASET POLYDATA\nPOINTS 3 float\n0 0 0 1 0 0 0 1 0\nPOLYGONS 1 4\n3 0 1 2\n"
    "POINT_DATA 3\nSCALARS stiffness float 1\nLOOKUP_TABLE default\n1 2 3\n")
put("mrk", "a.mrk.json", '{"markups":[{"type":"Fiducial","coordinateSystem":"LPS","controlPoints":[{"label":"a","position":[1,2,3]}]}]}')
put("mrk", "b.json", '[{"id":"a","coordinates":[1,2,3]}]')
put("fcsv", "a.fcsv", "# Markups fiducial file version = 4.11\n# CoordinateSystem = LPS\n# columns = id,x,y,z,ow,ox,oy,oz,vis,sel,lock,label,desc,associatedNodeID\n"
    "1,1,2,3,0,0,0,1,1,1,0,a,,\n")
put("h5json", "a.h5.json", '{"root":"g","groups":{"g":{"links":[{"class":"H5L_TYPE_HARD","collection":"groups","id":"m","title":"model"}]},'
    '"m":{"links":[{"class":"H5L_TYPE_HARD","collection":"datasets","id":"d","title":"mean"}]}},"datasets":{"d":{"shape":'
    '{"class":"H5S_SIMPLE","dims":[3]},"type":{"class":"H5T_FLOAT","base":"H5T_IEEE_F32LE"},"value":[1,2,3]}}}')
put("json", "a.json", '{"a":[1,-2.5e3,"x\\u00e9",null,true],"b":{"c":{}}}')
