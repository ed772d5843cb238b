import os
import struct
import tracemalloc
import warnings
import zlib
from concurrent.futures import ThreadPoolExecutor
from io import BytesIO

import numpy as np
import pytest
from PIL import Image

from harmface.conventions import srgb_to_linear
from harmface.errors import ArgumentError, FileError, FileWarning
from harmface.io import read_image, write_image
from harmface.io.png import png_encoding


@pytest.mark.parametrize("bits", [8, 16])
@pytest.mark.parametrize("shape", [(5, 7), (5, 7, 3)])
@pytest.mark.parametrize("srgb", [False, True])
def test_what_is_written_is_read_to_half_a_code(tmp_path, rng, bits, shape, srgb):
    image = rng.random(shape)
    write_image(tmp_path / "a.png", image, bits=bits, srgb=srgb)
    found = read_image(tmp_path / "a.png", srgb=srgb)
    # The sRGB curve is at most 1.06 / 2.4 / ... steep; its inverse magnifies a code by under 2.5.
    assert np.abs(found - image).max() <= (2.5 if srgb else 1) * 0.5 / (2**bits - 1) * (1 + 1e-9)


@pytest.mark.parametrize("name", ["a.pgm", "a.tiff", "a.bmp", "a.png"])
def test_other_programs_files_are_read(tmp_path, rng, name):
    codes = rng.integers(0, 256, (6, 4), dtype=np.uint8)
    Image.fromarray(codes).save(tmp_path / name)
    assert np.array_equal(read_image(tmp_path / name), codes / 255)


def targa(codes, *, rle=False, top=False, alpha_bits=0):
    """Return a TGA file by its specification, rows from the bottom unless `top`."""
    rows, columns = codes.shape[:2]
    pixels = codes[..., None] if codes.ndim == 2 else codes[..., [2, 1, 0, 3][: codes.shape[2]]]
    pixels = pixels if top else pixels[::-1]
    depth = 8 * pixels.shape[-1]
    kind = (3 if depth == 8 else 2) + (8 if rle else 0)
    header = struct.pack(
        "<3B5x2x2xHH2B", 0, 0, kind, columns, rows, depth, alpha_bits | (0x20 if top else 0)
    )
    if not rle:
        return header + pixels.tobytes()
    # Packets of at most 128 pixels as they are.
    flat = pixels.reshape(rows * columns, -1)
    body = b""
    for first in range(0, len(flat), 128):
        part = flat[first : first + 128]
        body += bytes([len(part) - 1]) + part.tobytes()
    return header + body


@pytest.mark.parametrize("rle", [False, True])
@pytest.mark.parametrize("top", [False, True])
@pytest.mark.parametrize("channels", [(), (3,)])
def test_targa_is_read_by_its_specification(tmp_path, rng, rle, top, channels):
    codes = rng.integers(0, 256, (17, 11, *channels), dtype=np.uint8)
    (tmp_path / "a.tga").write_bytes(targa(codes, rle=rle, top=top))
    assert np.array_equal(read_image(tmp_path / "a.tga"), codes / 255)
    codes[:, 2:9] = 7
    picture = Image.fromarray(codes)
    picture.save(tmp_path / "b.tga", compression="tga_rle" if rle else None)
    assert np.array_equal(read_image(tmp_path / "b.tga"), codes / 255)


def test_targa_of_32_bits_has_alpha_only_if_it_says_so(tmp_path, rng):
    codes = rng.integers(0, 256, (5, 4, 4), dtype=np.uint8)
    codes[..., 3] = 0
    (tmp_path / "a.tga").write_bytes(targa(codes))
    assert np.array_equal(read_image(tmp_path / "a.tga"), codes[..., :3] / 255)
    (tmp_path / "a.tga").write_bytes(targa(codes, alpha_bits=8))
    assert not read_image(tmp_path / "a.tga").any()
    Image.fromarray(codes[..., :2].copy(), "LA").save(tmp_path / "b.tga")
    with pytest.raises(FileError, match="has the channels"):
        read_image(tmp_path / "b.tga")


def test_a_targa_header_takes_no_memory(tmp_path):
    header = struct.pack("<3B5x2x2xHH2B", 0, 0, 10, 65535, 65535, 24, 0)
    (tmp_path / "a.tga").write_bytes(header + b"rest")
    with pytest.raises(FileError, match=r"implausible|more pixels than the limit"):
        read_image(tmp_path / "a.tga")


# What the eight orientations of EXIF do to a picture as stored, by their definition: which of its
# sides is the top row and which the left column.
ORIENTATIONS = {
    1: lambda a: a,
    2: np.fliplr,
    3: lambda a: np.rot90(a, 2),
    4: np.flipud,
    5: lambda a: a.T,
    6: lambda a: np.rot90(a, -1),
    7: lambda a: np.rot90(a, 2).T,
    8: lambda a: np.rot90(a, 1),
    9: lambda a: a,
}


@pytest.mark.parametrize("orientation", ORIENTATIONS)
@pytest.mark.parametrize("suffix", ["png", "tif", "jpg", "webp"])
def test_pictures_are_turned_as_their_file_says(tmp_path, suffix, orientation):
    codes = np.zeros((16, 24), np.uint8)
    codes[:8, :8], codes[:8, 8:] = 240, 120
    exif = Image.Exif()
    exif[0x112] = orientation
    path = tmp_path / f"a.{suffix}"
    Image.fromarray(codes).save(path, exif=exif, **({} if suffix == "tif" else {"quality": 100}))
    found = read_image(path)
    found = found if found.ndim == 2 else found[..., 1]
    expected = ORIENTATIONS[orientation](codes)
    assert found.shape == expected.shape
    assert np.abs(found * 255 - expected).max() <= 6


@pytest.mark.parametrize("largest", [1, 9, 100, 254, 255, 256, 1023, 4095, 65535])
@pytest.mark.parametrize("kind", ["P2", "P5"])
def test_codes_of_a_pgm_file_are_shares_of_its_largest(tmp_path, kind, largest):
    codes = np.unique(np.linspace(0, largest, 64).astype(int))
    header = f"{kind}\n# by hand\n{len(codes)} 1\n{largest}\n".encode()
    if kind == "P2":
        body = " ".join(map(str, codes)).encode()
    else:
        body = codes.astype("u1" if largest < 256 else ">u2").tobytes()
    (tmp_path / "a.pgm").write_bytes(header + body)
    found = read_image(tmp_path / "a.pgm")
    np.testing.assert_allclose(found, [codes / largest], rtol=0, atol=1e-15)


def tiff(pixels, predictor, coded):
    """Return a TIFF file of one deflated strip by its specification."""
    rows, columns, channels = pixels.shape
    data = zlib.compress(coded)
    bits = 8 * pixels.itemsize
    tags = [
        (256, 3, 1, columns),
        (257, 3, 1, rows),
        (258, 3, channels, 8),
        (259, 3, 1, 8),
        (262, 3, 1, 2),
        (273, 4, 1, 8 + 3 * channels * 2),
        (277, 3, 1, channels),
        (278, 3, 1, rows),
        (279, 4, 1, len(data)),
        (317, 3, 1, predictor),
        (339, 3, channels, 8 + channels * 2),
    ]
    values = struct.pack("<9H", *[bits] * 3, *[3 if pixels.dtype.kind == "f" else 1] * 3, 0, 0, 0)
    start = 8 + len(values) + len(data)
    entries = b"".join(struct.pack("<HHII", *tag) for tag in tags)
    directory = struct.pack("<H", len(tags)) + entries + bytes(4)
    return b"II*\0" + struct.pack("<I", start) + values + data + directory


def test_predictors_of_tiff_files_are_undone(tmp_path, rng):
    """2: differences from pixel to pixel; 3: of real numbers too, byte plane by byte plane."""
    codes = rng.integers(0, 65536, (3, 5, 3)).astype("<u2")
    differences = np.diff(codes, axis=1, prepend=np.zeros_like(codes[:, :1])).astype("<u2")
    (tmp_path / "a.tif").write_bytes(tiff(codes, 2, differences.tobytes()))
    assert np.array_equal(read_image(tmp_path / "a.tif"), codes / 65535)
    real = rng.normal(size=(3, 5, 3)).astype("<f4")
    planes = real.reshape(3, 15, 1).view(np.uint8)[..., ::-1].swapaxes(1, 2).reshape(3, -1)
    steps = planes.copy()
    steps[:, 3:] -= planes[:, :-3]
    (tmp_path / "b.tif").write_bytes(tiff(real, 3, steps.tobytes()))
    assert np.array_equal(read_image(tmp_path / "b.tif"), real.astype(float))
    (tmp_path / "c.tif").write_bytes(tiff(real, 1, real.tobytes()))
    assert np.array_equal(read_image(tmp_path / "c.tif"), real.astype(float))
    real[1, 2, 0] = np.nan
    (tmp_path / "d.tif").write_bytes(tiff(real, 1, real.tobytes()))
    with pytest.raises(FileError, match="NaN"):
        read_image(tmp_path / "d.tif")


@pytest.mark.parametrize("interlaced", [0, 1])
@pytest.mark.parametrize(("bits", "colour"), [(1, 0), (4, 3), (16, 0), (8, 2), (16, 2), (8, 6)])
def test_png_files_are_whole_or_refused(tmp_path, rng, bits, colour, interlaced, capfd):
    """A file by the specification, with its passes; and with every part of it damaged."""

    def chunk(name, body):
        return (
            struct.pack(">I", len(body)) + name + body + struct.pack(">I", zlib.crc32(name + body))
        )

    width, height, channels = 11, 9, {0: 1, 2: 3, 3: 1, 6: 4}[colour]
    codes = rng.integers(0, 2**bits, (height, width, channels))
    if colour == 6:
        codes[..., 3] = 255
    passes = (
        *((0, 0, 8, 8), (0, 4, 8, 8), (4, 0, 8, 4), (0, 2, 4, 4)),
        *((2, 0, 4, 2), (0, 1, 2, 2), (1, 0, 2, 1)),
    )
    rows = b""
    for top, left, down, right in passes if interlaced else ((0, 0, 1, 1),):
        for row in codes[top::down, left::right]:
            places = np.arange(bits)[::-1]
            rows += b"\0" + np.packbits(row.reshape(-1, 1) >> places & 1).tobytes()
    header = struct.pack(">II5B", width, height, bits, colour, 0, 0, interlaced)
    palette = rng.integers(0, 256, (16, 3), dtype=np.uint8)
    start = b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", header) + chunk(b"PLTE", palette.tobytes())
    start = start if colour == 3 else start[:33]
    pixels, end = chunk(b"IDAT", zlib.compress(rows)), chunk(b"IEND", b"")
    (tmp_path / "a.png").write_bytes(start + pixels + end)
    expected = palette[codes[..., 0]] / 255 if colour == 3 else codes[..., :3] / (2**bits - 1)
    found = read_image(tmp_path / "a.png")
    assert np.allclose(found if found.ndim == 3 else found[..., None], expected, atol=1e-15)
    for damaged, said in (
        (start + pixels, "cut off"),
        (start + chunk(b"IDAT", zlib.compress(rows[:-1])) + end, "not as many"),
        (start + chunk(b"IDAT", zlib.compress(rows + b"0")) + end, "not as many"),
        (start + chunk(b"IDAT", zlib.compress(b"\7" + rows[1:])) + end, "pixels are damaged"),
        (start + chunk(b"IDAT", b"no stream") + end, "header check"),
        (start + pixels[:-1] + b"x" + end, "checksum|cut off"),
        (start + chunk(b"XXXX", b"") + pixels + end, "unknown name"),
        (start + pixels + chunk(b"tEXt", b"a") + pixels + end, "scattered"),
        (start + end, "lacks a part"),
        (start[:33].replace(b"IHDR", b"IHDX") + pixels + end, "header is damaged"),
        (start[:24] + b"\3" + start[25:] + pixels + end, "header is damaged"),
        (start + chunk(b"PLTE", b"12") + pixels + end, "palette"),
    ):
        (tmp_path / "a.png").write_bytes(damaged)
        with pytest.raises(FileError, match=said):
            read_image(tmp_path / "a.png")
    assert capfd.readouterr() == ("", "")


def test_the_palette_of_os2_is_read(tmp_path):
    palette = b"".join(bytes([code, code // 2, code // 4]) for code in range(256))
    pixels = bytes([10, 200, 0, 0, 30, 40, 0, 0])  # from the bottom, rows of four bytes
    start = 14 + 12 + len(palette)
    header = b"BM" + struct.pack("<IHHI", start + len(pixels), 0, 0, start)
    header += struct.pack("<IHHHH", 12, 2, 2, 1, 8)
    (tmp_path / "a.bmp").write_bytes(header + palette + pixels)
    blue = np.array([[30, 40], [10, 200]])
    expected = np.stack([blue // 4, blue // 2, blue], axis=-1) / 255
    assert np.array_equal(read_image(tmp_path / "a.bmp"), expected)


def test_oddities_of_jpeg_files_are_told(tmp_path, rng):
    path = tmp_path / "a.jpg"
    picture = Image.fromarray(rng.integers(0, 256, (64, 64, 3), dtype=np.uint8))
    picture.convert("CMYK").save(path)
    with pytest.warns(FileWarning, match=r"a.jpg: holds CMYK"):
        assert read_image(path).shape == (64, 64, 3)
    picture.save(path)
    whole = path.read_bytes()
    # An early end of the data, with a marker as if all were well.
    path.write_bytes(whole[: len(whole) // 2] + b"\xff\xd9\xff\xd9" + whole[len(whole) // 2 + 4 :])
    with pytest.warns(FileWarning, match="premature end of data segment"):
        read_image(path)
    path.write_bytes(whole[: len(whole) // 2])
    with pytest.raises(FileError, match="cut off"):
        read_image(path)


def test_other_colours_in_tiff_files_are_told_or_refused(tmp_path):
    grey = Image.fromarray(np.full((4, 4, 3), 128, np.uint8))
    grey.convert("CMYK").save(tmp_path / "a.tif")
    with pytest.warns(FileWarning, match=r"a\.tif: holds CMYK, turned to RGB"):
        found = read_image(tmp_path / "a.tif")
    np.testing.assert_allclose(found, 128 / 255, atol=0.01)
    grey.convert("LAB").save(tmp_path / "a.tif")
    with pytest.raises(FileError, match=r"a\.tif: holds the colours CIELAB; save it as"):
        read_image(tmp_path / "a.tif")


@pytest.mark.parametrize(
    ("kind", "sample", "value"),
    [
        ("u4", 1, 0.75 * 2**32),
        ("u2", 1, 0.75 * 2**16),
        ("f4", 3, 0.75),
        ("f2", 3, 0.75),
        ("i2", 2, 1),
        ("i1", 2, 1),
    ],
)
def test_tiff_files_hold_numbers_of_many_kinds(tmp_path, kind, sample, value):
    """TIFF 6.0: SampleFormat 1 means numbers without sign, 2 with one, 3 floating point."""
    data = np.full((2, 3), value, f"<{kind}").tobytes()
    tags = {256: 3, 257: 2, 258: 8 * int(kind[1]), 259: 1, 262: 1, 273: 8, 277: 1, 278: 2}
    tags |= {279: len(data), 339: sample}
    entries = b"".join(struct.pack("<HHII", tag, 4, 1, number) for tag, number in tags.items())
    head = b"II*\0" + struct.pack("<I", 8 + len(data))
    (tmp_path / "a.tif").write_bytes(
        head + data + struct.pack("<H", len(tags)) + entries + bytes(4)
    )
    if sample == 2:
        with pytest.raises(FileError, match="holds signed integers"):
            read_image(tmp_path / "a.tif")
    else:
        np.testing.assert_allclose(read_image(tmp_path / "a.tif"), 0.75, atol=2e-5)


def test_hundreds_of_scans_are_refused(tmp_path, rng):
    path = tmp_path / "a.jpg"
    picture = Image.fromarray(rng.integers(0, 256, (16, 16), dtype=np.uint8))
    picture.save(path, progressive=True)
    whole = path.read_bytes()
    assert read_image(path).shape == (16, 16)
    last = whole.rindex(b"\xff\xda")
    path.write_bytes(whole[:last] + whole[last:-2] * 300 + whole[-2:])
    with pytest.raises(FileError, match=r"has \d+ scans, more than the limit of 50"):
        read_image(path)


def test_a_larger_picture_is_read_if_asked_for(tmp_path):
    write_image(tmp_path / "a.png", np.ones((3, 4)))
    with pytest.raises(FileError, match=r"4 x 3 pixels, more pixels than the limit of 11.*max_pix"):
        read_image(tmp_path / "a.png", max_pixels=11)
    assert read_image(tmp_path / "a.png", max_pixels=12).shape == (3, 4)


def test_reading_changes_nothing_that_other_threads_see(tmp_path, monkeypatch, rng):
    """Neither the files of the process nor the filters of warnings."""
    codes = rng.integers(0, 256, (8, 6), dtype=np.uint8)
    for name in ("a.png", "a.tif", "a.bmp", "a.jpg"):
        Image.fromarray(codes).save(tmp_path / name, quality=100)
    files = [tmp_path / name for name in ("a.png", "a.tif", "a.bmp", "a.jpg")]
    with monkeypatch.context() as patch, ThreadPoolExecutor(8) as pool:
        for module, name in (
            (os, "dup2"),
            (warnings, "catch_warnings"),
            (warnings, "simplefilter"),
        ):
            patch.setattr(module, name, None)
        found = list(pool.map(read_image, files[:3] * 32))
        list(pool.map(read_image, files))
    assert all(np.array_equal(image, codes / 255) for image in found)


def test_pictures_of_other_formats_are_refused(tmp_path):
    from harmface.io.exr import write_exr

    write_exr(tmp_path / "a.exr", np.ones((2, 4), np.float32))
    Image.fromarray(np.ones((2, 4), np.uint8)).save(tmp_path / "a.gif")
    (tmp_path / "a.pam").write_bytes(
        b"P7\nWIDTH 1\nHEIGHT 1\nDEPTH 1\nMAXVAL 255\nTUPLTYPE GRAYSCALE\nENDHDR\n\1"
    )
    for name in ("a.exr", "a.gif", "a.pam"):
        with pytest.raises(FileError, match="its bytes are not PNG, TIFF, JPEG"):
            read_image(tmp_path / name)


def test_several_pages_are_refused(tmp_path):
    pages = [Image.fromarray(np.full((2, 2), value, np.uint8)) for value in (1, 2)]
    pages[0].save(tmp_path / "a.tiff", save_all=True, append_images=pages[1:])
    with pytest.raises(FileError, match="several pages"):
        read_image(tmp_path / "a.tiff")


def test_channels_are_red_green_blue(tmp_path):
    codes = np.zeros((2, 2, 3), np.uint8)
    codes[..., 0] = 200
    Image.fromarray(codes).save(tmp_path / "a.png")
    assert np.allclose(read_image(tmp_path / "a.png"), codes / 255)
    Image.fromarray(codes).save(tmp_path / "a.jpg", quality=100, subsampling=0)
    assert np.abs(read_image(tmp_path / "a.jpg") - codes / 255).max() < 0.02


def test_other_channels_are_refused_before_they_are_decoded(tmp_path):
    """A thousand channels of 500 x 500 pixels take 250 MB, and pack to some hundred kB."""
    import OpenImageIO

    spec = OpenImageIO.ImageSpec(500, 500, 1000, "uint8")
    spec.attribute("compression", "zip")
    target = OpenImageIO.ImageOutput.create("a.tif")
    assert target.open(str(tmp_path / "a.tif"), spec)
    assert target.write_image(np.zeros((500, 500, 1000), np.uint8))
    target.close()
    tracemalloc.start()
    with pytest.raises(FileError, match=r"has the channels R, G, B, A, channel4.*grey or RGB"):
        read_image(tmp_path / "a.tif")
    assert tracemalloc.get_traced_memory()[1] < 2**24
    tracemalloc.stop()


def test_what_is_transparent_is_laid_on_black_in_linear_light(tmp_path):
    codes = np.full((2, 2, 4), 255, np.uint8)
    codes[..., 1] = 128
    Image.fromarray(codes).save(tmp_path / "a.png")
    whole = read_image(tmp_path / "a.png", srgb=True)
    assert whole.shape == (2, 2, 3)
    codes[0, :, 3] = 0, 51
    Image.fromarray(codes).save(tmp_path / "a.png")
    found = read_image(tmp_path / "a.png", srgb=True)
    assert np.array_equal(found[0, 0], np.zeros(3))
    np.testing.assert_allclose(found[0, 1], whole[0, 1] / 5, rtol=1e-12)
    assert np.array_equal(found[1], whole[1])


def test_opacity_goes_with_a_picture(tmp_path, rng, unchecked):
    opacity = np.array([[0, 0.2, 0.6, 1.0]])
    image = rng.uniform(0.1, 0.9, (1, 4, 3)) * opacity[..., None]
    for bits, srgb, tolerance in ((8, True, 0.008), (16, False, 3e-5)):
        write_image(tmp_path / "a.png", image, bits=bits, srgb=srgb, opacity=opacity)
        np.testing.assert_allclose(read_image(tmp_path / "a.png"), image, atol=tolerance)
    with Image.open(tmp_path / "a.png") as picture:
        assert picture.mode == "RGBA"
    write_image(tmp_path / "a.png", image[..., 0], opacity=opacity)
    np.testing.assert_allclose(read_image(tmp_path / "a.png")[..., 1], image[..., 0], atol=3e-5)
    for bad in (np.ones((4, 1)), opacity * 2, -opacity, opacity * np.nan):
        with pytest.raises(ArgumentError, match="opacity"):
            write_image(tmp_path / "a.png", image, opacity=bad)


@pytest.mark.parametrize(
    ("chunks", "says"),
    [
        ((), None),
        (((b"sRGB", b"\0"),), True),
        (((b"gAMA", (45455).to_bytes(4, "big")),), True),
        (((b"gAMA", (100000).to_bytes(4, "big")),), False),
        (((b"gAMA", (55556).to_bytes(4, "big")),), None),
        (((b"gAMA", (100000).to_bytes(4, "big")), (b"sRGB", b"\0")), True),
        (((b"iCCP", b"sRGB IEC61966-2.1\0\0x"),), True),
        (((b"iCCP", b"ProPhoto\0\0x"), (b"gAMA", (45455).to_bytes(4, "big"))), None),
    ],
)
def test_what_a_png_file_says_of_its_encoding_is_believed(tmp_path, chunks, says):
    buffer = BytesIO()
    Image.fromarray(np.full((2, 2), 128, np.uint8)).save(buffer, format="PNG")
    data = buffer.getvalue()
    for name, body in reversed(chunks):
        chunk = len(body).to_bytes(4, "big") + name + body
        chunk += zlib.crc32(name + body).to_bytes(4, "big")
        data = data[:33] + chunk + data[33:]
    assert png_encoding(data) is says
    linear, encoded = 128 / 255, srgb_to_linear(np.array(128 / 255))
    (tmp_path / "a.png").write_bytes(data)
    for srgb in (False, True):
        expected = encoded if (srgb if says is None else says) else linear
        try:
            found = read_image(tmp_path / "a.png", srgb=srgb)
        except FileError:  # the profile is no profile
            assert chunks[0][0] == b"iCCP"
            continue
        np.testing.assert_allclose(found, expected, rtol=1e-12)


@pytest.mark.parametrize(("name", "bits"), [("a.png", 8), ("a.png", 16), ("a.jpg", 8)])
def test_what_is_written_is_read_without_being_told_how(tmp_path, name, bits):
    y, x = np.mgrid[0:1:32j, 0:1:32j]
    image = np.stack([y, x, 0.5 * (x + y)], axis=-1)
    write_image(tmp_path / name, image, bits=bits, srgb=True)
    np.testing.assert_allclose(
        read_image(tmp_path / name), image, atol=0.04 if name == "a.jpg" else 0.006
    )
    with Image.open(tmp_path / name) as picture:
        says = picture.info if name == "a.png" else picture.getexif().get_ifd(0x8769)
    assert says.get("srgb", says.get(0xA001)) is not None
    Image.fromarray((255 * y).astype(np.uint8)).save(tmp_path / name)
    assert not np.allclose(read_image(tmp_path / name, srgb=True), y, atol=0.05)


def test_srgb_is_undone_only_on_request(tmp_path):
    Image.fromarray(np.full((2, 2), 188, np.uint8)).save(tmp_path / "a.png")
    assert read_image(tmp_path / "a.png")[0, 0] == 188 / 255
    assert read_image(tmp_path / "a.png", srgb=True)[0, 0] == srgb_to_linear(np.array(188 / 255))


@pytest.mark.parametrize("side", [12_000, 2**20])
def test_a_lying_header_takes_no_memory(tmp_path, side):
    def chunk(name, body):
        checksum = struct.pack(">I", zlib.crc32(name + body))
        return struct.pack(">I", len(body)) + name + body + checksum

    header = chunk(b"IHDR", struct.pack(">II5B", side, side, 8, 0, 0, 0, 0))
    body = chunk(b"IDAT", zlib.compress(b"\0" * 64))
    (tmp_path / "a.png").write_bytes(b"\x89PNG\r\n\x1a\n" + header + body)
    with pytest.raises(FileError, match="more pixels than the limit"):
        read_image(tmp_path / "a.png")


@pytest.mark.parametrize("suffix", ["png", "pgm", "tiff", "jpg", "tga"])
def test_broken_bytes_raise_file_errors_only(tmp_path, rng, suffix, capfd):
    path = tmp_path / f"a.{suffix}"
    Image.fromarray(rng.integers(0, 256, (16, 16), dtype=np.uint8)).save(path)
    whole = path.read_bytes()
    refused = 0
    for _ in range(60):
        broken = bytearray(whole)
        for position in rng.integers(len(whole), size=3):
            broken[position] = rng.integers(256)
        path.write_bytes(broken[: rng.integers(1, len(whole) + 1)])
        try:
            image = read_image(path)
        except FileError as error:
            refused += 1
            assert str(path) in str(error)
        else:
            assert np.isfinite(image).all()
    # Of a TGA file all bytes but the first 18 are pixels.
    assert refused > (10 if suffix == "tga" else 30)
    assert capfd.readouterr() == ("", "")


@pytest.mark.parametrize(
    ("name", "image", "bits", "error"),
    [
        ("a.gif", np.ones((2, 2)), 8, FileError),
        ("a.jpg", np.ones((2, 2)), 8, ArgumentError),
        ("a.jpg", np.ones((2, 2)), 16, ArgumentError),
        ("a.png", np.full((2, 2), np.nan), 8, ArgumentError),
        ("a.png", np.ones((2, 2, 2)), 8, ArgumentError),
        ("a.png", np.ones((2, 2)), 12, ArgumentError),
        ("a.png", np.ones((0, 2)), 8, ArgumentError),
        ("a.png", np.ones((2, 0, 3)), 8, ArgumentError),
        ("a.png", np.ones(2), 8, ArgumentError),
        ("a.png", np.ones((2, 2)) * 1j, 8, ArgumentError),
        ("a.png", np.full((2, 2), 200, np.uint8), 8, ArgumentError),
        ("a.png", np.ones((2, 2), bool), 8, ArgumentError),
        ("a.png", np.ones((1, 1_000_001)), 8, ArgumentError),
    ],
)
def test_nonsense_is_not_written(unchecked, tmp_path, name, image, bits, error):
    with pytest.raises(error):
        write_image(tmp_path / name, image, bits=bits)
    assert not list(tmp_path.iterdir())
