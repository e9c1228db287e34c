#!/usr/bin/env python3
"""Makes the small files that fuzzing starts from: make_seeds.py PROGRAM OUT_FOLDER. They are kept in tests/fuzz/seeds."""

import base64
import pathlib
import struct
import subprocess
import sys
import tempfile
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

# FreeSurfer's: version, size, frames, type, degrees of freedom, whether it is placed, spacing, axes, centre.
placed = struct.pack(">15f", 1, 2, 3, -1, 0, 0, 0, 0, -1, 0, 1, 0, 10, 20, 30)
for name, kind, good, frames, content in (("bytes.mgh", 0, 1, 1, voxels), ("shorts.mgh", 4, 1, 1, voxels * 2),
                                          ("cine.mgh", 3, 1, 2, struct.pack(">48f", *range(48))), ("unplaced.mgh", 0, 0, 1, voxels)):
    head_mgh = struct.pack(">7ih", 1, 4, 3, 2, frames, kind, 0, good) + (placed if good else b"")
    put("mgh", name, head_mgh.ljust(284, b"\0") + content)

# Names of labels, in every form that is read.
put("labels", "values.json", '{"1":"spleen","2":"kidney left"}')
put("labels", "names.json", '{"labels":{"background":0,"spleen":1,"kidney":[2,3]}}')
put("labels", "list.json", '[{"value":1,"name":"spleen","colour":"#9d6ca2"},{"label":2,"name":"liver","color":[221,130,101]}]')
put("labels", "itk-snap.label", '# ITK-SnAP Label Description File\n    0     0    0    0        0  0  0    "Clear Label"\n'
    '    1   255    0    0        1  1  1    "spleen"\n')
put("labels", "freesurfer.txt", "#No. Label Name:                            R   G   B   A\n\n0   Unknown                 0   0   0   0\n"
    "17  Left-Hippocampus        220 216 20  0\n")
put("labels", "plain.txt", "1 spleen\n2 left kidney\n")
put("labels", "columns.csv", "value,name,colour\n1,spleen,#9d6ca2\n2,\"kidney, left\",#b9663d\n")
put("labels", "channels.tsv", "index\tname\tr\tg\tb\n1\tspleen\t157\t108\t162\n")
put("labels", "semicolons.csv", "1;spleen\n2;liver\n")
put("labels", "table.xml", '<?xml version="1.0"?><CaretExtension><VolumeInformation Index="0"><LabelTable>'
    '<Label Key="1" Red="0.6" Green="0.4" Blue="0.6" Alpha="1"><![CDATA[spleen]]></Label></LabelTable></VolumeInformation></CaretExtension>')


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
for reader in ("ply", "vtk", "vtp", "vtu", "gii", "msh", "stl", "particles"):
    convert(out / "obj/a.obj", reader, "a." + reader)
convert(out / "obj/a.obj", "obj", "a.mni.obj")
put("msh", "four.msh", "$MeshFormat\n4.1 0 8\n$EndMeshFormat\n$Nodes\n1 4 1 4\n3 1 0 4\n1\n2\n3\n4\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n$EndNodes\n"
    "$Elements\n1 1 1 1\n3 1 4 1\n1 1 2 3 4\n$EndElements\n")
put("msh", "values.msh", "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n4\n1 0 0 0\n2 1 0 0\n3 0 1 0\n4 0 0 1\n$EndNodes\n$Elements\n2\n"
    "1 4 2 7 1 1 2 3 4\n2 4 2 8 1 1 2 3 4\n$EndElements\n$NodeData\n1\n\"doubt_mm\"\n1\n0\n3\n0 1 4\n1 1\n2 2\n3 3\n4 4\n$EndNodeData\n"
    "$ElementData\n1\n\"fibres\"\n1\n0\n3\n0\n3\n1\n1 1 0 0\n$EndElementData\n")
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

# Cases: of the octahedron and the image that the fuzzer lays beside them.
start = '{"homolog":1,"volume":"image.mha","template":"octahedron.obj","placement":{"rotation":[1,0,0,0],"scale":1,"translation":[0,0,0]}'
steps = base64.b64encode(zlib.compress(bytes([2] * 18 + [0] * 54))).decode()
put("case", "strokes.homolog", start + """}
{"tool":"pull","at":[1,0,0],"to":[1.2,0,0],"sigma_mm":1}
{"tool":"slide","at":[0,1,0],"to":[0,1,0.3],"on":[0,1,0.2],"sigma_mm":1}
{"tool":"relax","at":[1,0,0],"strength":1,"sigma_mm":1}
{"tool":"relax","at":[0,0,1],"strength":1,"sigma_mm":1,"joined":true}
{"undo":true}
{"redo":true}
{"spacing":0.5}
{"scheme":"paper","events":3}
{"tool":"grab","at":[0,0,1],"to":[0,0,1.5],"sigma_mm":2,"through_space":true}
{"note":"a remark","window":[-160,240]}
""")
put("case", "landmarks.homolog", start + ""","landmarks":"by size","held_landmarks":true}
{"template_landmark":{"name":"a","at":[1,0,0]}}
{"landmark":{"name":"a","at":[1.1,0,0]}}
{"landmark_fit":"warp"}
{"landmark":{"name":"a","at":null},"joined":true}
{"placement":{"rotation":[0,1,0,0],"scale":2,"translation":[1,2,3]}}
{"mirror":"sagittal"}
{"frame":0,"look":true}
{"start_frame_from":0}
""")
put("case", "regions.homolog", start + ""","vertices":6}
{"region":{"name":"r","factor":2,"colour":"#60a5d6"}}
{"paint_region":{"name":"r","at":[1,0,0],"radius_mm":1,"soft":0.5}}
{"fill_region":{"name":"r","at":[0,1,0],"by":"curvature","tolerance_per_mm":0.1}}
{"rename_region":{"name":"r","to":"s"}}
{"remove_region":"s"}
{"stiffness":{"at":[1,0,0],"radius_mm":1,"value":50,"soft":0}}
{"smooth_stiffness":{"at":[1,0,0],"radius_mm":1,"strength":0.5}}
{"stiffness_factors":[1,1,5,1,1,2]}
{"stiffness_base":10}
{"confirm":{"at":[1,0,0],"radius_mm":1,"hold":true}}
""")
put("case", "moved.homolog", start + '}\n{"by":"fit","moved":{"landmarks":6,"steps":"' + steps + '"}}\n'
    '{"points":[1,0,0,-1,0,0,0,1,0,0,-1,0,0,0,1,0,0,-1],"by":"snap"}\n')

put("study", "a.study.json", '{"homolog_study":1,"template":"octahedron.obj","cases":[{"name":"a","file":"a.homolog","state":"in work",'
    '"frame":1,"flipped":true,"from_scan":true,"labels":"l.nii","doubt":"d","seconds":1.5,"gestures":2,"group":"g","notes":"n"},'
    '{"name":"b","file":"octahedron.obj","imported":"b.ply","state":"to do","mine":1}]}')

put("log", "a.log", """{"do":"open","volume":"ct.nii","labels":"l.nii","template":"t.ply","in_place":true,"phantom":null}
{"do":"edit","action":{"tool":"pull","at":[1,0,0],"to":[1.2,0,0],"sigma_mm":1},"joined":false}
{"do":"edit","action":{"region":{"name":"pole","factor":1.0,"colour":"#e0a458"}},"joined":true}
{"do":"set template","label":1,"tube":false,"organ_options":{"vertices":600,"closing_mm":1.0,"opening_mm":null,"tunnels":"number","genus":0},"tube_options":{"rings":40,"sectors":64,"capped":false},"outer_label":0,"axis_by_ruler":false}
{"do":"set brush","radius_mm":10.0,"paints":"region","region":"","erases":false,"fill_by":"region","fill_tolerance_per_mm":0.05,"stiffness_factor":5.0,"soft":0.5,"hold":true}
{"do":"fit","label":1,"closing_mm":1.0,"as_placed":false,"model":"none","beyond":1.0}
{"do":"choose tool","tool":"stiffness"}
{"do":"look at","point_mm":[0,1,2]}
""")

# Models, as `model` writes them.
with tempfile.TemporaryDirectory() as folder:
    octahedron = (out / "obj/a.obj").read_text()
    shapes = []
    for k, stretched in enumerate(("v 1 0 0", "v 0 1 0", "v 0 0 1")):
        shapes.append(pathlib.Path(folder) / f"{k}.obj")
        shapes[-1].write_text(octahedron.replace(stretched, stretched.replace("1", "1.5")))
    for reader, name in (("h5", "a.h5"), ("model", "a.h5.json")):
        (out / reader).mkdir(parents=True, exist_ok=True)
        subprocess.run([program, "model", *map(str, shapes), "-o", str(out / reader / name)], check=True, stdout=subprocess.DEVNULL)
