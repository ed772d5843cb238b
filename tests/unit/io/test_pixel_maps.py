"""Normals and albedo of every pixel, from arrays and pictures."""

import numpy as np
import pytest
from PIL import Image

from harmface.errors import FileError
from harmface.io import read_albedo_map, read_normal_map

NORMALS = np.array([[[0.0, 0, 1], [0.6, 0, 0.8]], [[0, -0.8, 0.6], [0, 0, 0]]])


def test_normals_of_an_array(tmp_path):
    np.save(tmp_path / "n.npy", NORMALS.astype(np.float32))
    np.testing.assert_allclose(read_normal_map(tmp_path / "n.npy"), NORMALS, atol=1e-7)


@pytest.mark.parametrize("background", ["black", "transparent"])
@pytest.mark.parametrize("marked", [False, True])
def test_normals_of_a_picture_are_its_codes(tmp_path, background, marked):
    """Whatever a chunk says of the encoding: components are no light."""
    codes = np.rint(127.5 * (NORMALS + 1)).astype(np.uint8)
    seen = NORMALS.any(axis=2)
    if background == "black":
        codes[~seen] = 0
    else:
        codes = np.dstack([codes, 255 * seen.astype(np.uint8)])
    if marked:
        data = _with_srgb_chunk(codes, tmp_path)
        (tmp_path / "n.png").write_bytes(data)
    else:
        Image.fromarray(codes).save(tmp_path / "n.png")
    found = read_normal_map(tmp_path / "n.png")
    # Half a code of 255 for each component, over a length that is made one.
    np.testing.assert_allclose(found, NORMALS, atol=0.006)
    np.testing.assert_allclose(np.linalg.norm(found, axis=2), seen, atol=1e-12)


def _with_srgb_chunk(codes, folder):
    import zlib

    Image.fromarray(codes).save(folder / "plain.png")
    data = (folder / "plain.png").read_bytes()
    body = b"sRGB\0"
    chunk = (1).to_bytes(4, "big") + body + zlib.crc32(body).to_bytes(4, "big")
    # After the header of 8 + 25 bytes.
    return data[:33] + chunk + data[33:]


@pytest.mark.parametrize(
    ("array", "message"),
    [
        (NORMALS[..., :2], "three components"),
        (NORMALS[0], "three components"),
        (0 * NORMALS, "none is there"),
        (1.1 * NORMALS, "3 of 3 are not"),
        (np.nan * NORMALS, "no array of real numbers"),
    ],
)
def test_what_holds_no_normals_is_refused(tmp_path, array, message):
    np.save(tmp_path / "n.npy", array)
    with pytest.raises(FileError, match=message):
        read_normal_map(tmp_path / "n.npy")


def test_albedo_of_an_array_is_not_negative(tmp_path):
    np.save(tmp_path / "a.npy", np.full((2, 3), 0.5))
    np.testing.assert_array_equal(read_albedo_map(tmp_path / "a.npy"), np.full((2, 3), 0.5))
    np.save(tmp_path / "a.npy", np.full((2, 3), -0.5))
    with pytest.raises(FileError, match="albedo must not be negative"):
        read_albedo_map(tmp_path / "a.npy")
