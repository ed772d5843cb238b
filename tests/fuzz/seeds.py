"""Small sound files of each format, as the package and other programs write them."""

import io
import json
import struct
import tempfile
from collections.abc import Callable
from pathlib import Path

import numpy as np
from PIL import Image

Files = dict[str, bytes]
"""Content by name; the first is what is read."""

GREY = (np.arange(48).reshape(6, 8) * 5).astype(np.uint8)
COLOUR = np.stack([GREY, GREY[::-1], 255 - GREY], axis=-1)
RADIANCE = (COLOUR / 64).astype(np.float32)
POINTS = np.array([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0.5], [0.5, 0.5, 1]], float)
FACES = np.array([[0, 1, 4], [1, 2, 4], [2, 3, 4], [3, 0, 4]])


def written(name: str, write: Callable[[Path], object]) -> bytes:
    """Return the bytes of a file that is written by name only."""
    with tempfile.TemporaryDirectory() as folder:
        write(Path(folder, name))
        return Path(folder, name).read_bytes()


def by_pillow(pixels: np.ndarray, kind: str, mode: str = "", **options: object) -> bytes:
    buffer = io.BytesIO()
    image = Image.fromarray(pixels)
    (image.convert(mode) if mode else image).save(buffer, kind, **options)
    return buffer.getvalue()


def mesh():
    from harmface.geometry import Mesh, vertex_normals

    return Mesh(POINTS, FACES, vertex_normals(POINTS, FACES), np.full((5, 3), 0.5))


def obj() -> list[Files]:
    from harmface.io import write_obj

    with tempfile.TemporaryDirectory() as folder:
        write_obj(Path(folder, "m.obj"), mesh(), COLOUR / 255, POINTS[:, :2])
        ours = {name: Path(folder, name).read_bytes() for name in ("m.obj", "m.mtl", "m.png")}
    plain = b"o a\nv 0 0 0 1 0 0\nv 1 0 0 0 1 0\nv 1 1 0 0 0 1\nv 0 1 0 1 1 1\ns 1\n"
    plain += b"g a b\nf 1 2 3 4\nf -4 -2 -1\nf 1// 2// 3//\nl 1 2\n"
    return [ours, {"m.obj": plain}]


def ply() -> list[Files]:
    from harmface.io import write_ply

    head = b"element vertex 4\nproperty float x\nproperty float y\nproperty float z\n"
    colours = b"property uchar red\nproperty uchar green\nproperty uchar blue\n"
    faces = b"element face 2\nproperty list uchar int vertex_indices\nend_header\n"
    text = b"ply\nformat ascii 1.0\ncomment a\n" + head + colours + faces
    text += b"0 0 0 255 0 0\n1 0 0 0 255 0\n1 1 0 0 0 255\n0 1 0 9 9 9\n4 0 1 2 3\n3 0 1 2\n"
    big = b"ply\nformat binary_big_endian 1.0\n" + head + faces
    big += struct.pack(">12f", 0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0)
    big += struct.pack(">B3iB3i", 3, 0, 1, 2, 3, 0, 2, 3)
    return [
        {"m.ply": data} for data in (written("m.ply", lambda p: write_ply(p, mesh())), text, big)
    ]


def glb() -> list[Files]:
    import trimesh

    from harmface.io import write_glb

    material = trimesh.visual.material.PBRMaterial(
        baseColorTexture=Image.fromarray(COLOUR), baseColorFactor=[200, 100, 50, 255]
    )
    visual = trimesh.visual.TextureVisuals(uv=POINTS[:, :2], material=material)
    textured = trimesh.Trimesh(POINTS, FACES, visual=visual, process=False)
    return [
        {"m.glb": written("m.glb", lambda p: write_glb(p, mesh()))},
        {"m.glb": trimesh.exchange.gltf.export_glb(trimesh.Scene(textured))},
    ]


def stl() -> list[Files]:
    import trimesh

    part = trimesh.Trimesh(POINTS, FACES, process=False)
    text = trimesh.exchange.stl.export_stl_ascii(part).encode()
    return [{"m.stl": trimesh.exchange.stl.export_stl(part)}, {"m.stl": text}]


def png() -> list[Files]:
    from harmface.io import write_image

    exif = Image.Exif()
    exif[0x112] = 6
    pictures = [
        written("i.png", lambda p: write_image(p, COLOUR / 255)),
        by_pillow(GREY, "PNG"),
        by_pillow(COLOUR, "PNG", "P"),
        by_pillow(GREY, "PNG", "1"),
        by_pillow(COLOUR, "PNG", "RGBA", exif=exif),
        by_pillow(GREY.astype(np.uint16) * 257, "PNG", dpi=(72, 72)),
    ]
    return [{"i.png": data} for data in pictures]


def jpeg() -> list[Files]:
    exif = Image.Exif()
    exif[0x112] = 3
    pictures = [
        by_pillow(GREY, "JPEG"),
        by_pillow(COLOUR, "JPEG", exif=exif),
        by_pillow(COLOUR, "JPEG", progressive=True),
        by_pillow(COLOUR, "JPEG", "CMYK"),
    ]
    return [{"i.jpg": data} for data in pictures]


def tiff() -> list[Files]:
    second = Image.fromarray(GREY)
    pictures = [
        by_pillow(GREY, "TIFF"),
        by_pillow(COLOUR, "TIFF", compression="tiff_lzw"),
        by_pillow(COLOUR, "TIFF", compression="tiff_adobe_deflate"),
        by_pillow(GREY.astype(np.uint16) * 257, "TIFF"),
        by_pillow(GREY.astype(np.float32) / 255, "TIFF"),
        by_pillow(COLOUR, "TIFF", compression="packbits"),
        by_pillow(GREY, "TIFF", save_all=True, append_images=[second]),
    ]
    return [{"i.tif": data} for data in pictures]


def pgm() -> list[Files]:
    high = GREY.astype(np.uint16) * 4
    pictures = [
        b"P5\n# made\n8 6\n255\n" + GREY.tobytes(),
        b"P5 8 6 1023\n" + high.astype(">u2").tobytes(),
        b"P2\n8 6\n255\n" + " ".join(map(str, GREY.ravel())).encode() + b"\n",
        b"P6\n8 6\n255\n" + COLOUR.tobytes(),
        b"P3 2 1 15\n1 2 3 4 5 6\n",
        b"P4\n8 6\n" + bytes(range(6)),
        b"P5\n8 6\n65535\n" + high.astype(">u2").tobytes(),
    ]
    return [{"i.pgm": data} for data in pictures]


def bmp() -> list[Files]:
    modes = ("", "P", "1", "L")
    return [{"i.bmp": by_pillow(COLOUR, "BMP", mode)} for mode in modes]


def tga() -> list[Files]:
    return [
        {"i.tga": by_pillow(COLOUR, "TGA")},
        {"i.tga": by_pillow(COLOUR, "TGA", "RGBA", compression="tga_rle")},
        {"i.tga": by_pillow(GREY, "TGA")},
    ]


def latlong() -> np.ndarray:
    return np.tile(RADIANCE[:4], (1, 1, 1))


def hdr() -> list[Files]:
    from harmface.io import write_environment_map

    head = b"#?RADIANCE\n# by hand\nFORMAT=32-bit_rle_rgbe\nEXPOSURE=2.0\nGAMMA=1\n\n"
    flat = head + b"-Y 4 +X 8\n" + bytes([128, 64, 32, 129]) * 32
    old = head + b"-Y 4 +X 8\n" + bytes([128, 128, 128, 129, 1, 1, 1, 7]) * 4
    ours = written("e.hdr", lambda p: write_environment_map(p, latlong()))
    wide = written("e.hdr", lambda p: write_environment_map(p, np.tile(latlong(), (4, 4, 1))))
    return [{"e.hdr": data} for data in (ours, wide, flat, old)]


def exr() -> list[Files]:
    import OpenEXR

    def make(kind: int, tiled: bool, channels: dict[str, np.ndarray]) -> bytes:
        header = {"compression": kind}
        header["type"] = OpenEXR.tiledimage if tiled else OpenEXR.scanlineimage
        if tiled:
            header["tiles"] = OpenEXR.TileDescription()
        return written("e.exr", lambda p: OpenEXR.File(header, channels).write(str(p)))

    full = np.ascontiguousarray(latlong())
    half = {"RGB": full.astype(np.float16)}
    pictures = [
        make(OpenEXR.ZIP_COMPRESSION, False, {"RGB": full}),
        make(OpenEXR.NO_COMPRESSION, False, {"Y": full[..., 0].copy()}),
        make(OpenEXR.RLE_COMPRESSION, False, half),
        make(OpenEXR.PIZ_COMPRESSION, False, half),
        make(OpenEXR.PXR24_COMPRESSION, False, {"RGB": full}),
        make(OpenEXR.B44_COMPRESSION, False, half),
        make(OpenEXR.DWAA_COMPRESSION, False, half),
        make(OpenEXR.ZIP_COMPRESSION, False, {"RGBA": np.ones((4, 8, 4), np.float32)}),
    ]
    return [{"e.exr": data} for data in pictures]


def pfm() -> list[Files]:
    from harmface.io import write_environment_map

    big = b"Pf 8 4 1.0\n" + latlong()[..., 0].astype(">f4").tobytes()
    ours = written("e.pfm", lambda p: write_environment_map(p, latlong()))
    return [{"e.pfm": ours}, {"e.pfm": big}]


def gallery() -> list[Files]:
    from harmface.io import write_gallery
    from harmface.recognition import Gallery, Photographs, SubjectClassifier

    rng = np.random.default_rng(0)
    photographs = Photographs(np.array(["a", "a", "b", "b"]), rng.random((4, 5, 6)))
    plain = Gallery(photographs, photographs.everywhere, relit=photographs, facts={"srgb": False})
    harmonic = Gallery(photographs, photographs.everywhere, harmonic=rng.random((2, 9, 5, 6)))
    classifiers = [
        SubjectClassifier.from_gallery(plain, "relit+local"),
        SubjectClassifier.from_gallery(harmonic, "9d"),
    ]
    return [
        {"g.npz": written("g.npz", lambda p, each=each: write_gallery(p, each))}
        for each in classifiers
    ]


def surface() -> list[Files]:
    from harmface.geometry import depth_to_mesh
    from harmface.io import write_ply

    depth = 1 + np.arange(12.0).reshape(3, 4)
    mesh = depth_to_mesh(depth, np.ones(depth.shape, bool))
    arrays = {"normals": mesh.normals.reshape(3, 4, 3), "albedo": depth / 12, "depth": depth}
    files = {"mesh.ply": written("mesh.ply", lambda p: write_ply(p, mesh))}
    for name, array in {**arrays, "confidence": depth / 12}.items():
        files[f"{name}.npy"] = written("a.npy", lambda p, array=array: np.save(p, array))
    # Each of them comes first once, and is what is damaged.
    return [{name: files[name], **files} for name in files]


def probe_grid() -> list[Files]:
    from harmface.io import write_probe_grid
    from harmface.light import ProbeGrid

    grid = ProbeGrid(np.zeros(3), np.ones(3), np.ones((2, 2, 2, 3, 9)))
    return [{"p.npz": written("p.npz", lambda p: write_probe_grid(p, grid))}]


def transfer() -> list[Files]:
    from harmface.io import write_transfer
    from harmface.rendering import Transfer

    found = Transfer(np.ones((9, len(POINTS))), np.zeros(9), 0.0)
    return [{"t.npz": written("t.npz", lambda p: write_transfer(p, found, mesh()))}]


def scene() -> list[Files]:
    text = b"""frame = "object"
[[polygon]]
vertices = [[1, 0, 1], [1, 1, 1], [2, 1, 1]]
radiance = [1, 0.5, 0.25]
[[disc]]
center = [0, 3, 0]
normal = [0, -1, 0]
radius = 0.5
radiance = 2
[[sphere]]
center = [4, 0, 0]
radius = 0.5
radiance = 2
[[point]]
position = [0, 0, 5]
intensity = 3
"""
    return [{"scene.toml": text}]


def normal_map() -> list[Files]:
    normals = np.zeros((3, 4, 3))
    normals[1:, :, 2] = 1
    codes = np.rint(127.5 * (normals + 1)).astype(np.uint8) * normals.any(axis=2, keepdims=True)
    array = written("n.npy", lambda p: np.save(p, normals))
    return [{"n.npy": array}, {"n.png": by_pillow(codes.astype(np.uint8), "PNG")}]


def tool_coefficients() -> list[Files]:
    values = [[0.8, 0.1, 0.2, 0.3, 0.0, 0.0, 0.1, 0.0, -0.1]] * 3
    probe = {"object": {"type": "LightProbe", "intensity": 1, "sh": np.ravel(values).tolist()}}
    array = written("c.npy", lambda p: np.save(p, np.array(values).T))
    text = "".join(f"({', '.join(map(str, row[:3]))}); // L00\n" for row in values * 3)
    return [{"c.json": json.dumps(probe).encode()}, {"c.npy": array}, {"sh.txt": text.encode()}]


def folder() -> Files:
    """Photographs in the DiLiGenT layout."""
    names = [f"{number:03d}.png" for number in range(1, 5)]
    files = {"filenames.txt": "\n".join(names).encode()}
    files["light_directions.txt"] = b"0 0 1\n.5 0 .866\n0 .5 .866\n-.5 0 .866\n"
    files["light_intensities.txt"] = b"1 1 1\n2 2 2\n1 1 1\n1 1 1\n"
    files["mask.png"] = by_pillow(np.full((6, 8), 255, np.uint8), "PNG")
    return files | {name: by_pillow(COLOUR, "PNG") for name in names}


def capture() -> list[Files]:
    return [folder(), dict(reversed(list(folder().items())))]


def mat() -> list[Files]:
    from scipy.io import savemat

    normals = np.zeros((6, 8, 3))
    normals[..., 2] = 1
    others = {"c": np.array([{"a": 1}, "text", np.eye(2)], object), "s": {"x": 1.0, "t": "abc"}}

    def make(content: dict[str, object], **options: object) -> bytes:
        buffer = io.BytesIO()
        savemat(buffer, content, **options)
        return buffer.getvalue()

    truth = {"Normal_gt": normals}
    files = [
        make(truth, do_compression=True),
        make(truth),
        make(others | truth),
        make({"Normal_gt": normals.astype(np.float32)}),
        make({"Normal_gt": normals[..., 0]}, format="4"),
    ]
    return [{"Normal_gt.mat": data, **folder()} for data in files]


def coefficients() -> list[Files]:
    table = [[0.8, 0.1, 0.2, 0.3, 0.0, 0.0, 0.1, 0.0, -0.1]] * 3
    return [{"c.json": json.dumps({"coefficients": table}, indent=1).encode()}]


def manifest() -> list[Files]:
    image = {"file": "i.png", "light": "a", "subset": None, "exposure": 1.0}
    image["irradiances"] = {"direction": [0, 1], "value": [1.0, 0.5]}
    subject = {"name": "s", "seed": 1, "directions": [[0, 0, 1], [1, 0, 0]], "images": [image]}
    content = {"format": "harmface-dataset", "version": 1, "subjects": [subject]}
    picture = by_pillow(GREY, "PNG")
    text = json.dumps(content, indent=1).encode()
    return [{"manifest.json": text, "s/i.png": picture, "s/mask.png": picture}]


def lights() -> list[Files]:
    texts = (
        b"0 0 1\n.5 0 .866\n-.5 0 .866\n0 .5 .866\n0 -.5 .866\n",
        b"# x, y, z, strength\n5\n0,0,1,2\n.5,0,.866,1\n-.5,0,.866,1\n0,.5,.866,1\n0,-.5,.866,1\n",
        b"0 .5 -.5 0 0\n0 0 0 .5 -.5\n1 .866 .866 .866 .866\n",
    )
    return [{"lights.txt": text} for text in texts]


def measured_normals() -> list[Files]:
    return [{"normals.txt": b"# column row x y z\n1 2 0 0 1\n2 3 .6 0 .8\n4 0 0 -.6 .8\n"}]


def measured_directions() -> list[Files]:
    return [{"lamps.txt": b"# number x y z\n1 0 0 1\n5 0 .6 .8\n3 -.6 0 .8\n"}]


def listed() -> list[Files]:
    picture = by_pillow(GREY, "PNG")
    names = ("a/1.png", "a/2.png", "b/1.png", "b/2.png")
    return [{"list.txt": b"1.png\n\n", **dict.fromkeys(names, picture)}]
