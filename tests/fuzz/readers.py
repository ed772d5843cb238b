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
from harmface.io import (
    choose_gallery,
    find_photographs,
    read_capture,
    read_coefficients,
    read_dataset,
    read_environment_map,
    read_gallery,
    read_image,
    read_lights,
    read_measured_directions,
    read_measured_normals,
    read_mesh,
    read_normal_map,
    read_probe_grid,
    read_scene,
    read_surface,
    read_tool_coefficients,
    read_transfer,
)

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


def _read_folder(path: Path) -> Any:
    return read_capture([path.parent])


def _read_all(path: Path) -> Any:
    found = read_dataset(path.parent)
    return [(found.lights(s), found.images(s), found.mask(s)) for s in found.subjects]


def _read_surface(path: Path) -> Any:
    return read_surface(path.parent)


def _read_five_lights(path: Path) -> Any:
    return read_lights(path, 5)


def _read_normals_of_twenty(path: Path) -> Any:
    return read_measured_normals(path, (4, 5))


def _read_directions_of_five(path: Path) -> Any:
    return read_measured_directions(path, 5)


def _read_transfer(path: Path) -> Any:
    return read_transfer(path, seeds.mesh())


def _read_scene(path: Path) -> Any:
    return read_scene(path, seeds.mesh())


def _read_tool(path: Path) -> Any:
    tool = {".npy": "deca", ".txt": "filament"}.get(path.suffix, "three.js")
    return read_tool_coefficients(path, tool)


def _choose(path: Path) -> Any:
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
        read_mesh,
        (
            b"\nf ~\nv ~/~mtllib /dev/zero\n~\nusemtl a\n~map_Kd /dev/zero\n"
            b"~\nmap_Kd ../m.obj\n~\nKd ~\\\n~\nvt 1~\nf 1 2 3 4 5 6 7\n~-"
        ).split(b"~"),
        odd=odd.obj,
    ),
    "ply": Reader(
        seeds.ply,
        read_mesh,
        (
            b"element vertex 4294967295\n~property double nx\n~element face 0\n~ascii"
            b"~property list int int x\n~end_header\n~property uchar alpha\n~-1 "
            b"~comment TextureFile /dev/zero\n~property list uchar float texcoord\n"
        ).split(b"~"),
        odd=odd.ply,
    ),
    "glb": Reader(seeds.glb, read_mesh, JSON + GLTF, containers.GLB, odd=odd.glb),
    "stl": Reader(seeds.stl, read_mesh, (b"facet normal ", b"vertex ", b"endloop", b"solid ")),
    "png": Reader(
        seeds.png,
        read_image,
        (b"IHDR", b"IDAT", b"PLTE", b"tRNS", b"iCCP", b"zTXta\0\0", b"acTL", b"fdAT", b"eXIf"),
        containers.PNG,
        odd.png,
    ),
    "jpeg": Reader(
        seeds.jpeg,
        read_image,
        (
            b"\xff\xd8~\xff\xc0~\xff\xc4~\xff\xda~\xff\xdb~\xff\xdd\x00\x04\x00\x01~\xff\xe1"
            b"~\xff\xd9~\xff\xee\x00\x0eAdobe~\xff\xc2"
        ).split(b"~"),
        odd=odd.jpeg,
    ),
    "tiff": Reader(seeds.tiff, read_image, TIFF_TAGS, odd=odd.tiff),
    "pgm": Reader(
        seeds.pgm,
        read_image,
        (b"#", b"P5 ", b"P7\n", b"\n", b" 65536 ", b"99999 99999 "),
        odd=odd.pgm,
    ),
    "bmp": Reader(seeds.bmp, read_image, (b"BM", b"\x28\0\0\0", b"\x0c\0\0\0", b"\1\0\0\0")),
    "tga": Reader(seeds.tga, read_image, (b"TRUEVISION-XFILE.\0",)),
    "hdr": Reader(
        seeds.hdr,
        read_environment_map,
        (
            b"EXPOSURE=0\n~EXPOSURE=1e-300\n~FORMAT=32-bit_rle_xyze\n~+X ~-X ~+Y "
            b"~COLORCORR=1 2 3\n~PRIMARIES=\n~\r\n~\n\n~\x02\x02\x00\x08"
        ).split(b"~"),
        odd=odd.hdr,
    ),
    "exr": Reader(
        seeds.exr,
        read_environment_map,
        (
            b"chlist\x00~box2i\x00~dataWindow\x00~compression\x00~tiles\x00~type\x00"
            b"~deepscanline~chunkCount\x00~lineOrder\x00~chromaticities\x00~BY\x00~RY\x00"
        ).split(b"~"),
    ),
    "pfm": Reader(
        seeds.pfm, read_environment_map, (b"PF", b"-0", b"\x00\x00\xc0\x7f", b"\x00\x00\x80\x7f")
    ),
    "gallery": Reader(
        seeds.gallery,
        read_gallery,
        (*JSON, b"'descr': '|O'", b"'<f8'"),
        containers.NPZ,
        odd=odd.gallery,
    ),
    "surface": Reader(
        seeds.surface, _read_surface, (b"'descr': '|O'", b"'<f8'", b"(3, 4)", b"\xff\xff\xff\x7f")
    ),
    "probe grid": Reader(
        seeds.probe_grid,
        read_probe_grid,
        (*JSON, b"'descr': '|O'"),
        containers.NPZ,
        odd=odd.probe_grid,
    ),
    "transfer": Reader(seeds.transfer, _read_transfer, (*JSON, b"'descr': '|O'"), containers.NPZ),
    "scene": Reader(
        seeds.scene, _read_scene, (b"[[", b"]]", b"nan", b"1e400", b"'''", b"inf", b'file = "/"\n')
    ),
    "normal map": Reader(
        seeds.normal_map,
        read_normal_map,
        (b"'descr': '|O'", b"'<f8'", b"(3, 4, 3)", b"\xff\xff\xff\x7f"),
    ),
    "tool coefficients": Reader(
        seeds.tool_coefficients, _read_tool, (*JSON, b"'descr': '|O'", b"nan", b"//", b"1e400")
    ),
    "mat": Reader(
        seeds.mat,
        _read_folder,
        (b"\x0e\0\0\0", b"\x01\0\0\0", b"\x0f\0\0\0", b"\x06\0\0\0", b"\xff\xff\xff\x7f"),
        containers.MAT,
        odd.mat,
    ),
    "capture": Reader(
        seeds.capture,
        _read_folder,
        (b"..", b"/", b"\x00", b"nan ", b"1e200 ", b"#"),
        odd=odd.capture,
    ),
    "coefficients": Reader(seeds.coefficients, read_coefficients, JSON, odd=odd.coefficients),
    "manifest": Reader(seeds.manifest, _read_all, JSON, odd=odd.manifest),
    "lights": Reader(
        seeds.lights,
        _read_five_lights,
        (b"#", b";", b"1e200 1e200 1e200\n", b"inf ", b"1j "),
        odd=odd.lights,
    ),
    "measured normals": Reader(
        seeds.measured_normals, _read_normals_of_twenty, (b"#", b";", b"1e200", b"inf ", b"-")
    ),
    "measured directions": Reader(
        seeds.measured_directions, _read_directions_of_five, (b"#", b";", b"1e200", b"inf ", b"-")
    ),
    "gallery list": Reader(seeds.listed, _choose, (b"\x00", b"/", b"..", b"\n", b"a/1.png\n")),
}
