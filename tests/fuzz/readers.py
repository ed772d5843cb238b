"""Every reader of files from outside, with sound files to start from."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from fuzz import containers, odd, seeds
from fuzz.containers import Container
from fuzz.mutate import mutated
from fuzz.seeds import Files

OTHER_FILE = 0.15
"""Share of cases that damage a file beside the one that is named."""


@dataclass(frozen=True)
class Reader:
    """A format: sound files, how they are read, and what is peculiar to it."""

    seeds: Callable[[], list[Files]]
    read: Callable[[Path], Any]
    tokens: Sequence[bytes] = ()
    container: Container | None = None
    odd: Callable[[], list[Files]] = list


def damaged(reader: Reader, sound: list[Files], rng: np.random.Generator) -> Files:
    """Return sound files after some damage."""
    files = dict(sound[rng.integers(len(sound))])
    first, *others = files
    if others and rng.random() < OTHER_FILE:
        name = others[rng.integers(len(others))]
        files[name] = mutated(files[name], rng, reader.tokens)
    elif reader.container is not None and rng.random() < 0.7:
        parts = reader.container.parts(files[first])
        which = rng.integers(len(parts))
        parts[which] = mutated(parts[which], rng, reader.tokens)
        files[first] = reader.container.whole(parts)
    else:
        files[first] = mutated(files[first], rng, reader.tokens)
    return files


def _mesh(path: Path) -> Any:
    from harmface.io import read_mesh

    return read_mesh(path)


def _image(path: Path) -> Any:
    from harmface.io import read_image

    return read_image(path)


def _map(path: Path) -> Any:
    from harmface.io import read_environment_map

    return read_environment_map(path)


def _gallery(path: Path) -> Any:
    from harmface.io import read_gallery

    return read_gallery(path)


def _grid(path: Path) -> Any:
    from harmface.io import read_probe_grid

    return read_probe_grid(path)


def _capture(path: Path) -> Any:
    from harmface.io import read_capture

    return read_capture([path.parent])


def _coefficients(path: Path) -> Any:
    from harmface.io import read_coefficients

    return read_coefficients(path)


def _dataset(path: Path) -> Any:
    from harmface.io import read_dataset

    found = read_dataset(path.parent)
    return [(found.lights(s), found.images(s), found.mask(s)) for s in found.subjects]


def _lights(path: Path) -> Any:
    from harmface.io import read_lights

    return read_lights(path, 5)


def _listed(path: Path) -> Any:
    from harmface.io import choose_gallery, find_photographs

    return choose_gallery(find_photographs(path.parent), str(path))


JSON = (b'"', b"{", b"]", b"null", b"1e999", b"NaN", b"\\u0000", b"\\ud800", b"\xff")
GLTF = (b'"extensionsRequired":["KHR_draco_mesh_compression"],', b'"uri":"/dev/zero",', b"5121")
TIFF_TAGS = (
    b"\x00\x01\x04\x00",
    b"\x02\x01\x03\x00",
    b"\x11\x01",
    b"\x17\x01",
    b"\x3d\x01\x03\x00",
)

READERS: dict[str, Reader] = {
    "obj": Reader(
        seeds.obj,
        _mesh,
        (
            b"\nf ~\nv ~/~mtllib /dev/zero\n~\nusemtl a\n~map_Kd /dev/zero\n"
            b"~\nmap_Kd ../m.obj\n~\nKd ~\\\n~\nvt 1~\nf 1 2 3 4 5 6 7\n~-"
        ).split(b"~"),
        odd=odd.obj,
    ),
    "ply": Reader(
        seeds.ply,
        _mesh,
        (
            b"element vertex 4294967295\n~property double nx\n~element face 0\n~ascii"
            b"~property list int int x\n~end_header\n~property uchar alpha\n~-1 "
            b"~comment TextureFile /dev/zero\n~property list uchar float texcoord\n"
        ).split(b"~"),
        odd=odd.ply,
    ),
    "glb": Reader(seeds.glb, _mesh, JSON + GLTF, containers.GLB, odd=odd.glb),
    "stl": Reader(seeds.stl, _mesh, (b"facet normal ", b"vertex ", b"endloop", b"solid ")),
    "png": Reader(
        seeds.png,
        _image,
        (b"IHDR", b"IDAT", b"PLTE", b"tRNS", b"iCCP", b"zTXta\0\0", b"acTL", b"fdAT", b"eXIf"),
        containers.PNG,
        odd.png,
    ),
    "jpeg": Reader(
        seeds.jpeg,
        _image,
        (
            b"\xff\xd8~\xff\xc0~\xff\xc4~\xff\xda~\xff\xdb~\xff\xdd\x00\x04\x00\x01~\xff\xe1"
            b"~\xff\xd9~\xff\xee\x00\x0eAdobe~\xff\xc2"
        ).split(b"~"),
        odd=odd.jpeg,
    ),
    "tiff": Reader(seeds.tiff, _image, TIFF_TAGS, odd=odd.tiff),
    "pgm": Reader(
        seeds.pgm, _image, (b"#", b"P5 ", b"P7\n", b"\n", b" 65536 ", b"99999 99999 "), odd=odd.pgm
    ),
    "bmp": Reader(seeds.bmp, _image, (b"BM", b"\x28\0\0\0", b"\x0c\0\0\0", b"\1\0\0\0")),
    "tga": Reader(seeds.tga, _image, (b"TRUEVISION-XFILE.\0",)),
    "hdr": Reader(
        seeds.hdr,
        _map,
        (
            b"EXPOSURE=0\n~EXPOSURE=1e-300\n~FORMAT=32-bit_rle_xyze\n~+X ~-X ~+Y "
            b"~COLORCORR=1 2 3\n~PRIMARIES=\n~\r\n~\n\n~\x02\x02\x00\x08"
        ).split(b"~"),
        odd=odd.hdr,
    ),
    "exr": Reader(
        seeds.exr,
        _map,
        (
            b"chlist\x00~box2i\x00~dataWindow\x00~compression\x00~tiles\x00~type\x00"
            b"~deepscanline~chunkCount\x00~lineOrder\x00~chromaticities\x00~BY\x00~RY\x00"
        ).split(b"~"),
    ),
    "pfm": Reader(seeds.pfm, _map, (b"PF", b"-0", b"\x00\x00\xc0\x7f", b"\x00\x00\x80\x7f")),
    "gallery": Reader(
        seeds.gallery,
        _gallery,
        (*JSON, b"'descr': '|O'", b"'<f8'"),
        containers.NPZ,
        odd=odd.gallery,
    ),
    "probe grid": Reader(
        seeds.probe_grid, _grid, (*JSON, b"'descr': '|O'"), containers.NPZ, odd=odd.probe_grid
    ),
    "mat": Reader(
        seeds.mat,
        _capture,
        (b"\x0e\0\0\0", b"\x01\0\0\0", b"\x0f\0\0\0", b"\x06\0\0\0", b"\xff\xff\xff\x7f"),
        containers.MAT,
        odd.mat,
    ),
    "capture": Reader(
        seeds.capture, _capture, (b"..", b"/", b"\x00", b"nan ", b"1e200 ", b"#"), odd=odd.capture
    ),
    "coefficients": Reader(seeds.coefficients, _coefficients, JSON, odd=odd.coefficients),
    "manifest": Reader(seeds.manifest, _dataset, JSON, odd=odd.manifest),
    "lights": Reader(
        seeds.lights, _lights, (b"#", b";", b"1e200 1e200 1e200\n", b"inf ", b"1j "), odd=odd.lights
    ),
    "gallery list": Reader(seeds.listed, _listed, (b"\x00", b"/", b"..", b"\n", b"a/1.png\n")),
}
