"""Files made to be expensive or confusing, the smallest of each kind known."""

import io
import json
import struct
import zlib

import numpy as np

from fuzz import containers, seeds
from fuzz.seeds import Files

DEEP = b"[" * 100_000
FIFO = b"<fifo>"
"""Content that stands for a named pipe that nobody writes to."""


def obj() -> list[Files]:
    triangle = b"v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n"
    many = b"".join(b"newmtl m%d\nmap_Kd t.png\n" % number for number in range(10_000))
    used = b"".join(b"usemtl m%d\nf 1 2 3\n" % number for number in range(10_000))
    picture = seeds.by_pillow(np.zeros((256, 256, 3), np.uint8), "PNG")
    return [
        {"m.obj": b"mtllib m.mtl\n" + triangle, "m.mtl": FIFO},
        {"m.obj": b"mtllib m.mtl\nusemtl a\n" + triangle, "m.mtl": b"newmtl a\nmap_Kd /dev/zero\n"},
        {"m.obj": b"mtllib m.mtl\n" + triangle + used, "m.mtl": many, "t.png": picture},
        {"m.obj": b"mtllib " + b"x" * 5000 + b"\n" + triangle},
        {"m.obj": b"mtllib a\0b\n" + triangle},
        {"m.obj": FIFO},
    ]


def ply() -> list[Files]:
    head = b"ply\nformat binary_little_endian 1.0\nelement vertex 4294967295\n"
    return [
        {"m.ply": head + b"property double x\nproperty double y\nproperty double z\nend_header\n"}
    ]


def glb() -> list[Files]:
    texts = [
        DEEP,
        b'{"accessors":[{"count":1e999}]}',
        b"[]",
        b"null",
        b'{"asset":{"version":"2.0"}}',
    ]
    loop = {"asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0]}]}
    loop["nodes"] = [{"children": [1]}, {"children": [0]}]
    texts.append(json.dumps(loop).encode())
    return [{"m.glb": containers.glb_whole([text, bytes(72)])} for text in texts]


def png() -> list[Files]:
    side = struct.pack(">IIBBBBB", 2**31 - 1, 2**31 - 1, 16, 6, 0, 0, 0)
    huge = containers.png_whole([b"IHDR" + side, b"IDAT" + bytes(100), b"IEND"])
    plain = containers.png_parts(seeds.by_pillow(seeds.GREY, "PNG"))
    bomb = zlib.compress(bytes(2**28), 9)
    profile = b"iCCP" + b"x\0\0" + bomb
    text = b"zTXt" + b"x\0\0" + bomb
    return [
        {"i.png": huge},
        {"i.png": containers.png_whole([plain[0], profile, text, *plain[1:]])},
        {"i.png": FIFO},
    ]


def jpeg() -> list[Files]:
    data = seeds.by_pillow(np.zeros((2000, 2000, 3), np.uint8), "JPEG", progressive=True)
    last = data.rindex(b"\xff\xda")
    return [{"i.jpg": data[:-2] + data[last:-2] * 300 + data[-2:]}]


def tiff() -> list[Files]:
    # 60,000 pages of one grey pixel, all of them the same byte of the file, by tag and value.
    tags = {256: 1, 257: 1, 258: 8, 259: 1, 262: 1, 273: 8, 277: 1, 278: 1, 279: 1}
    entries = b"".join(struct.pack("<HHII", tag, 4, 1, value) for tag, value in tags.items())
    first, length = 10, 2 + len(entries) + 4
    pages = b"".join(
        struct.pack("<H", len(tags)) + entries + struct.pack("<I", first + number * length)
        for number in range(1, 60_001)
    )
    pages = pages[:-4] + bytes(4)  # none comes after the last
    return [{"i.tif": b"II*\0" + struct.pack("<I", first) + b"\x80\0" + pages}]


def pgm() -> list[Files]:
    return [{"i.pgm": b"P5 99999 99999 255\n"}, {"i.pgm": b"P2 40000 3000 255\n1"}]


def hdr() -> list[Files]:
    return [{"e.hdr": b"#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 8192 +X 16384\n" + bytes(10_000)}]


def npz(name: str) -> list[Files]:
    descriptions = (
        DEEP,
        b"(" * 3000,
        b"'\n",
        b"{'descr': '<f8', 'shape': (1e999,)}",
        b"-" * 10_000,
    )
    return [
        {
            name: containers.npz_whole(
                [b"header.npy\0\x93NUMPY\2\0" + struct.pack("<I", len(text)) + text]
            )
        }
        for text in descriptions
    ]


def gallery() -> list[Files]:
    # A gibibyte of zeros in a megabyte.
    array = io.BytesIO()
    header = {"descr": "<f8", "fortran_order": False, "shape": (4, 2**12, 2**13)}
    np.lib.format.write_array_header_1_0(array, header)
    parts = containers.npz_parts(seeds.gallery()[0]["g.npz"])
    zeros = b"photographs.npy\0" + array.getvalue() + bytes(2**30)
    parts = [zeros if part.startswith(b"photographs") else part for part in parts]
    return [{"g.npz": containers.npz_whole(parts)}, *npz("g.npz")]


def probe_grid() -> list[Files]:
    return npz("p.npz")


def capture() -> list[Files]:
    files = seeds.folder()
    return [
        {"filenames.txt": b"a\0b.png", **{k: v for k, v in files.items() if k != "filenames.txt"}},
        {"filenames.txt": b"x" * 5000},
        {**files, "light_directions.txt": b"1e200 1e200 1e200\n" * 4},
    ]


def mat() -> list[Files]:
    # A cell that holds a cell that holds a cell: flags, dimensions 1 x 1, no name.
    flags = struct.pack("<IIII", 6, 8, 1, 0)
    dimensions = struct.pack("<IIii", 5, 8, 1, 1)
    name = struct.pack("<II", 1, 0)
    depth, own = 100_000, 48
    cells = b"".join(
        struct.pack("<II", 14, own * (depth - level) - 8)
        + flags[:8]
        + flags[8:]
        + dimensions
        + name
        for level in range(depth)
    )
    head = b"MATLAB 5.0 MAT-file".ljust(124) + struct.pack("<HH", 0x0100, 0x4D49)
    return [{"Normal_gt.mat": head + cells, **seeds.folder()}]


def coefficients() -> list[Files]:
    long = b'{"coefficients": [[' + b"0.125, " * 5_000_000 + b"0.125]]}"
    texts = (b'{"coefficients": [[1' + b"0" * 400 + b"]]}", b"[[1" + b"0" * 400 + b"]]", DEEP, long)
    texts += (b'{"coefficients": [[1' + b"0" * 5000 + b"]]}", b'{"coefficients": "1"}', b"1")
    return [{"c.json": text} for text in texts]


def manifest() -> list[Files]:
    base = seeds.manifest()[0]
    content = json.loads(base["manifest.json"])
    changes = ({"name": ["a"]}, {"name": 1}, {"images": [{"file": 1}]}, {"directions": "x"})
    changed = [{**content, "subjects": [{**content["subjects"][0], **each}]} for each in changes]
    changed += [{**content, "subjects": 1}, {**content, "version": 10**30}, [content]]
    return [{**base, "manifest.json": json.dumps(each).encode()} for each in changed]


def lights() -> list[Files]:
    texts = (b"1e200 1e200 1e200\n" * 5, b"1 2 3\n" * 1_000_000, b"1 " * 2_000_000, b"5\n" * 5)
    return [{"lights.txt": text} for text in texts]
