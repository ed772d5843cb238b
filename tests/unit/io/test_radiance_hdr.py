"""Radiance pictures as other programs write them; every file is made here, byte by byte."""

import numpy as np
import pytest

from harmface.errors import FileError, FileWarning
from harmface.io.radiance_hdr import read_radiance_hdr

RGBE = "#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n"
ONE = bytes([128, 128, 128, 129])
"""A pixel that is (1, 1, 1)."""


def read(tmp_path, header, pixels, **options):
    path = tmp_path / "a.hdr"
    path.write_bytes(header.encode() + pixels)
    return read_radiance_hdr(path, **options)


@pytest.mark.parametrize(
    ("lines", "value"),
    [
        ("EXPOSURE=0\n", 1),
        ("EXPOSURE=0\nEXPOSURE=4\n", 1 / 4),
        ("EXPOSURE=2\nEXPOSURE= 4 \n", 1 / 8),
        ("\tpfilt EXPOSURE=2\n\tEXPOSURE=2\n# EXPOSURE=2\n", 1),
        ("COLORCORR=1 2 4\nCOLORCORR=2 2 2\nEXPOSURE=2\n", (1 / 4, 1 / 8, 1 / 16)),
        ("PRIMARIES=0 0 0 0 0 0 0 0\n", 1),
        ("PRIMARIES=0.640 0.330 0.300 0.600 0.150 0.060 0.3127 0.3290\n", 1),
        ("VIEW= -vtv -vh 60 -vv 40\nPIXASPECT=1\n", 1),
    ],
)
def test_variables_of_the_header_are_honoured(tmp_path, lines, value):
    found = read(tmp_path, f"{RGBE}{lines}\n-Y 2 +X 4\n", ONE * 8)
    np.testing.assert_allclose(found, np.broadcast_to(value, (2, 4, 3)), rtol=1e-6)


@pytest.mark.parametrize(
    "header",
    [
        "#?RADIANCE\r\nFORMAT=32-bit_rle_rgbe\r\n\r\n-Y 2 +X 4\r\n",
        "#?RADIANCE\n\n-Y 2 +X 4\n",
        "#?RGBE\nFORMAT = 32-bit_rle_rgbe \n\n\n -Y  2  +X  4 \n",
        "#?AUTOPANO\nFORMAT=32-bit_rle_rgbe\n \n-Y 2 +X 4\n",
        "FORMAT=32-bit_rle_rgbe\n\n-Y 2 +X 4\n",
    ],
)
def test_headers_of_other_programs_are_understood(tmp_path, header):
    np.testing.assert_array_equal(read(tmp_path, header, ONE * 8), np.ones((2, 4, 3)))


@pytest.mark.parametrize(
    ("size", "order"),
    [
        ("-Y 2 +X 3", lambda row, column: (row, column)),
        ("-Y 2 -X 3", lambda row, column: (row, 2 - column)),
        ("+Y 2 +X 3", lambda row, column: (1 - row, column)),
        ("+Y 2 -X 3", lambda row, column: (1 - row, 2 - column)),
        ("+X 3 -Y 2", lambda row, column: (column, row)),
        ("-X 3 -Y 2", lambda row, column: (2 - column, row)),
        ("+X 3 +Y 2", lambda row, column: (column, 1 - row)),
        ("-X 3 +Y 2", lambda row, column: (2 - column, 1 - row)),
    ],
)
def test_pixels_come_in_eight_orders(tmp_path, size, order):
    """A picture whose red is 2**row and green 2**column, stored scanline by scanline."""
    scanlines, length = (3, 2) if "X" in size[:2] else (2, 3)
    stored = bytearray(4 * 6)
    for row in range(2):
        for column in range(3):
            scanline, place = order(row, column)
            start = 4 * (scanline * length + place)
            stored[start : start + 4] = bytes([32 << row, 32 << column, 0, 131])
    assert scanlines * length == 6
    found = read(tmp_path, f"{RGBE}\n{size}\n", bytes(stored))
    assert found.shape == (2, 3, 3)
    np.testing.assert_array_equal(found[..., 0], [[1, 1, 1], [2, 2, 2]])
    np.testing.assert_array_equal(found[..., 1], [[1, 2, 4], [1, 2, 4]])


def test_old_run_lengths_repeat_the_pixel_before(tmp_path):
    two = bytes([128, 128, 128, 130])
    rows = ONE + bytes([1, 1, 1, 15]) + two + bytes([1, 1, 1, 15])
    found = read(tmp_path, f"{RGBE}\n-Y 2 +X 16\n", rows)
    np.testing.assert_array_equal(found[..., 1], np.repeat([[1.0], [2.0]], 16, axis=1))
    # Of two runs in a row the second counts 256 times as much.
    runs = ONE + bytes([1, 1, 1, 44]) + bytes([1, 1, 1, 1]) + two
    found = read(tmp_path, f"{RGBE}\n-Y 1 +X 302\n", runs)
    np.testing.assert_array_equal(found[0, :, 2], [1.0] * 301 + [2.0])


def test_new_run_lengths_and_flat_pixels_that_look_like_them(tmp_path):
    scanline = bytes([2, 2, 0, 16]) + bytes([128 + 16, 128]) * 2 + bytes([16]) + bytes(16)
    new = scanline + bytes([128 + 16, 129])
    found = read(tmp_path, f"{RGBE}\n-Y 2 +X 16\n", new * 2)
    np.testing.assert_array_equal(found, np.tile([1.0, 1.0, 0.0], (2, 16, 1)))
    # A pixel of 2, 2, 0, 16 first, and one of 1, 1, 1, 129, in a picture without run lengths.
    flat = bytes([2, 2, 0, 16]) + bytes([1, 1, 1, 129]) + ONE * 30
    found = read(tmp_path, f"{RGBE}\n-Y 2 +X 16\n", flat)
    np.testing.assert_array_equal(found[0, :2, 0], [2.0 ** (1 + 16 - 136), 1 / 128])
    np.testing.assert_array_equal(found.reshape(-1, 3)[2:], np.ones((30, 3)))


def test_xyz_is_expressed_in_rec_709(tmp_path):
    """D65 white, X Y Z = 0.9505, 1, 1.0890, is equal red, green and blue (IEC 61966-2-1)."""
    white = bytes([round(0.9505 * 64), 64, round(1.0890 * 64), 130])
    header = "#?RADIANCE\nFORMAT=32-bit_rle_xyze\n\n-Y 2 +X 4\n"
    found = read(tmp_path, header, white * 8)
    # The codes are rounded to 1/128; blue weighs Z by 1.06, red X by 3.2.
    np.testing.assert_allclose(found, np.ones((2, 4, 3)), atol=4.3 / 128)
    luminance = found @ np.array([0.2126, 0.7152, 0.0722])
    np.testing.assert_allclose(luminance, 1, atol=1e-4)


def test_other_primaries_keep_white_and_are_converted(tmp_path):
    """The red of Rec. 2020 is 1.6605 of the red of Rec. 709 (ITU-R BT.2087, D65 both)."""
    rec2020 = "PRIMARIES=0.708 0.292 0.170 0.797 0.131 0.046 0.3127 0.3290\n"
    reddish = bytes([128, 64, 64, 129])  # half of white, half of red
    found = read(tmp_path, f"{RGBE}{rec2020}\n-Y 1 +X 2\n", reddish + ONE)
    np.testing.assert_allclose(2 * found[0, 0] - 1, [1.6605, -0.1246, -0.0182], atol=1e-4)
    np.testing.assert_allclose(found[0, 1], [1, 1, 1], atol=1e-6)
    with pytest.warns(FileWarning, match=r"50\.00% of its pixels have colours beyond Rec\. 709"):
        found = read(tmp_path, f"{RGBE}{rec2020}\n-Y 1 +X 2\n", bytes([128, 0, 0, 129]) + ONE)
    np.testing.assert_allclose(found[0], [[1.6605, 0, 0], [1, 1, 1]], atol=1e-4)
    equal_energy = "PRIMARIES=.64 .33 .29 .6 .15 .06 .3333 .3333\n"
    found = read(tmp_path, f"{RGBE}{equal_energy}\n-Y 1 +X 2\n", ONE * 2)
    np.testing.assert_allclose(found, np.ones((1, 2, 3)), atol=1e-5)


@pytest.mark.parametrize(
    ("size", "pixels", "said"),
    [
        ("-Y 2 +X 4", bytes([1, 1, 1, 8]), "starts with a run"),
        ("-Y 2 +X 4", ONE + bytes([1, 1, 1, 255]) * 4, "2 \\* 4|8 are promised"),
        ("-Y 2 +X 4", ONE + bytes([1, 1, 1, 1]) * 5, "more than four bytes"),
        ("-Y 2 +X 4", ONE + bytes([1, 1, 1, 6]), "8 are promised"),
        ("-Y 2 +X 4", ONE * 8 + bytes([1, 1, 1, 0]) + ONE, "8 are promised"),
        ("-Y 2 +X 8", bytes([2, 2, 0, 8, *4 * [136, 1], 2, 2, 0, 9]), "another length"),
        ("-Y 2 +X 8", bytes([2, 2, 0, 8, *4 * [136, 1], 2, 2]), "cut off"),
        ("-Y 1 +X 8", bytes([2, 2, 0, 8, 0, 0, 0, 0, 0, 0, 0, 0, 0]), "no length"),
        ("-Y 1 +X 8", bytes([2, 2, 0, 8, 137, 0, 136, 0, 136, 0, 136, 0]), "longer than"),
        ("-Y 1 +X 8", bytes([2, 2, 0, 8, 136, 0, 136, 0, 136, 0, 8, 0, 0, 0]), "cut off"),
    ],
)
def test_runs_that_do_not_fit_are_refused(tmp_path, size, pixels, said):
    with pytest.raises(FileError, match=said):
        read(tmp_path, f"{RGBE}\n{size}\n", pixels)


@pytest.mark.parametrize(
    ("lines", "said"),
    [
        ("EXPOSURE=1e200\nEXPOSURE=1e200\n", r"EXPOSURE and COLORCORR multiply to \[inf"),
        ("EXPOSURE=1e-200\nEXPOSURE=1e-200\n", r"EXPOSURE and COLORCORR multiply to \[0\.0"),
        # Beyond single precision, which values are of.
        ("EXPOSURE=1e39\n", r"EXPOSURE and COLORCORR multiply to \[1e\+39"),
        ("EXPOSURE=1e-60\n", r"EXPOSURE and COLORCORR multiply to \[1e-60"),
        ("EXPOSURE=-1\n", "EXPOSURE is not a positive number, but '-1'"),
        ("EXPOSURE=1 2\n", "EXPOSURE is not a positive number"),
        ("COLORCORR=1 2\n", "COLORCORR is not 3 positive numbers"),
        ("COLORCORR=1 x 2\n", "COLORCORR is not 3 positive numbers"),
        ("PRIMARIES=\n", "PRIMARIES are not eight numbers"),
        ("PRIMARIES=.64 .33 x .6 .15 .06 .3 .3\n", "PRIMARIES are not eight numbers"),
        ("PRIMARIES=.64 .33 .64 .33 .15 .06 .3 .3\n", "PRIMARIES are of no use"),
        ("FORMAT=32-bit_rle_xyze\n", "holds 32-bit_rle_rgbe, 32-bit_rle_xyze"),
    ],
)
def test_variables_that_make_no_sense_are_refused(tmp_path, lines, said):
    with pytest.raises(FileError, match=said):
        read(tmp_path, f"{RGBE}{lines}\n-Y 2 +X 4\n", ONE * 8)


def test_a_larger_picture_is_read_if_asked_for(tmp_path):
    header, pixels = f"{RGBE}\n-Y 2 +X 4\n", ONE * 8
    with pytest.raises(FileError, match="more pixels than the limit of 7"):
        read(tmp_path, header, pixels, max_pixels=7)
    assert read(tmp_path, header, pixels, max_pixels=8).shape == (2, 4, 3)


def test_messages_repeat_little_of_a_file(tmp_path):
    with pytest.raises(FileError) as error:
        read(tmp_path, f"#?RADIANCE\nEXPOSURE={'x' * 9999}\n\n-Y 2 +X 4\n", ONE * 8)
    assert len(str(error.value)) < 300 + len(str(tmp_path))
