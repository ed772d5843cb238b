import struct
import zlib

import numpy as np
import pytest
from PIL import Image

from harmface.conventions import srgb_to_linear
from harmface.errors import ArgumentError, FileError
from harmface.io import read_image, write_image


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
    with pytest.raises(FileError, match="partly transparent"):
        read_image(tmp_path / "a.tga")
    Image.fromarray(codes[..., :2].copy(), "LA").save(tmp_path / "b.tga")
    with pytest.raises(FileError, match="partly transparent"):
        read_image(tmp_path / "b.tga")


def test_a_targa_header_takes_no_memory(tmp_path):
    header = struct.pack("<3B5x2x2xHH2B", 0, 0, 10, 65535, 65535, 24, 0)
    (tmp_path / "a.tga").write_bytes(header + b"rest")
    with pytest.raises(FileError, match="more pixels than the limit"):
        read_image(tmp_path / "a.tga")


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


def test_an_opaque_alpha_channel_is_dropped_and_another_refused(tmp_path):
    codes = np.full((2, 2, 4), 255, np.uint8)
    Image.fromarray(codes).save(tmp_path / "a.png")
    assert read_image(tmp_path / "a.png").shape == (2, 2, 3)
    codes[0, 0, 3] = 0
    Image.fromarray(codes).save(tmp_path / "a.png")
    with pytest.raises(FileError, match="partly transparent"):
        read_image(tmp_path / "a.png")


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
        ("a.jpg", np.ones((2, 2)), 8, FileError),
        ("a.png", np.full((2, 2), np.nan), 8, ArgumentError),
        ("a.png", np.ones((2, 2, 2)), 8, ArgumentError),
        ("a.png", np.ones((2, 2)), 12, ArgumentError),
    ],
)
def test_nonsense_is_not_written(tmp_path, name, image, bits, error):
    with pytest.raises(error):
        write_image(tmp_path / name, image, bits=bits)
    assert not list(tmp_path.iterdir())
