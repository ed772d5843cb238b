import contextlib
import os
import struct
from concurrent.futures import ThreadPoolExecutor

import numpy as np
import OpenEXR
import pytest

from harmface.errors import ArgumentError, FileError, FileWarning
from harmface.io.environment_maps import read_environment_map, write_environment_map
from harmface.io.exr import read_exr, write_exr

IMAGE = np.random.default_rng(7).gamma(0.5, size=(8, 16, 3)).astype(np.float32)


@pytest.mark.parametrize("image", [IMAGE - 1, IMAGE[..., 0]])
def test_pictures_come_back_exactly(tmp_path, image):
    path = tmp_path / "map.exr"
    write_exr(path, image)
    np.testing.assert_array_equal(read_exr(path), image)


def test_maps_are_read_and_written(tmp_path):
    path = tmp_path / "map.exr"
    write_environment_map(path, IMAGE)
    np.testing.assert_array_equal(read_environment_map(path).as_image(), IMAGE)


def test_half_precision_is_read_and_alpha_left_out(tmp_path):
    path = tmp_path / "half.exr"
    alpha = np.concatenate([IMAGE, np.ones((8, 16, 1))], axis=-1).astype(np.float16)
    with OpenEXR.File({}, {"RGBA": alpha}) as file:
        file.write(str(path))
    np.testing.assert_array_equal(read_exr(path), alpha[..., :3].astype(np.float32))


def test_other_channels_are_refused_by_name(tmp_path):
    path = tmp_path / "depth.exr"
    with OpenEXR.File({}, {"Z": IMAGE[..., 0].copy()}) as file:
        file.write(str(path))
    with pytest.raises(FileError, match="no channels R, G, B or Y, but Z"):
        read_exr(path)


def test_headers_of_many_gigapixels_take_no_memory(tmp_path):
    path = tmp_path / "huge.exr"
    write_exr(path, IMAGE)
    window = np.array([0, 0, 15, 7], "<i4").tobytes()
    data = path.read_bytes()
    assert data.count(window) == 2  # data window and display window
    path.write_bytes(data.replace(window, np.array([0, 0, 99_999, 999_999], "<i4").tobytes()))
    with pytest.raises(FileError, match=r"100000 x 1000000 pixels|exceeds the \d+ MB limit"):
        read_exr(path)


def test_damaged_files_raise_file_errors_only_and_print_nothing(tmp_path, capfd):
    path = tmp_path / "map.exr"
    write_exr(path, IMAGE)
    data = path.read_bytes()
    rng = np.random.default_rng(1)
    refused = 0
    for _ in range(200):
        damaged = bytearray(data)
        for place in rng.integers(0, len(data), rng.integers(1, 8)):
            damaged[place] ^= 1 << rng.integers(8)
        path.write_bytes(damaged[: rng.integers(1, 2 * len(data))])
        try:
            read_exr(path)
        except FileError as error:
            assert "\n" not in str(error)
            refused += 1
    assert 30 < refused < 200
    assert capfd.readouterr() == ("", "")


def test_lost_pixels_are_told_in_the_words_of_the_library(tmp_path):
    path = tmp_path / "map.exr"
    write_exr(path, IMAGE)
    data = bytearray(path.read_bytes())
    # The table of the one chunk's place ends where the chunk starts, with its row and its length.
    start = next(n for n in range(8, len(data)) if int.from_bytes(data[n - 8 : n], "little") == n)
    data[start : start + 4] = (5).to_bytes(4, "little")
    path.write_bytes(data)
    with pytest.raises(FileError, match="chunks were missing or corrupted"):
        read_exr(path)


@pytest.mark.parametrize("image", [np.full((2, 4), np.inf), np.ones((2, 4, 2)), np.ones((2, 0))])
def test_what_is_no_picture_is_refused(unchecked, tmp_path, image):
    with pytest.raises(ArgumentError, match="image"):
        write_exr(tmp_path / "out.exr", image)


def test_missing_files_are_named(tmp_path):
    with pytest.raises(FileError, match="does not exist"):
        read_exr(tmp_path / "none.exr")


ONES = np.ones((4, 8), np.float32)


def save(path, *parts):
    """Write parts by OpenEXR's own library: a header's additions, and channels."""
    headers = [
        {"compression": OpenEXR.ZIP_COMPRESSION, "type": OpenEXR.scanlineimage, **header}
        for header, _ in parts
    ]
    found = [
        OpenEXR.Part(header, {name: np.float32(value) for name, value in channels.items()})
        for header, (_, channels) in zip(headers, parts, strict=True)
    ]
    with OpenEXR.File(found) as file:
        file.write(str(path))
    return path


def window(x, y, width, height):
    return np.array([x, y], "i4"), np.array([x + width - 1, y + height - 1], "i4")


@pytest.mark.parametrize(
    ("data", "rows", "columns"),
    [
        ((2, 1, 8, 4), slice(1, 5), slice(2, 10)),
        ((-3, -2, 8, 4), slice(0, 2), slice(0, 5)),
        ((12, 6, 8, 4), slice(6, 8), slice(12, 16)),
        ((-1, 1, 20, 4), slice(1, 5), slice(0, 16)),
    ],
)
def test_the_data_window_is_put_where_it_is_in_the_display_window(tmp_path, data, rows, columns):
    header = {"dataWindow": window(*data), "displayWindow": window(0, 0, 16, 8)}
    path = save(tmp_path / "a.exr", (header, {"Y": np.ones(data[:1:-1])}))
    expected = np.zeros((8, 16))
    expected[rows, columns] = 1
    np.testing.assert_array_equal(read_exr(path), expected)


def test_windows_that_do_not_meet_or_are_huge_are_refused(tmp_path):
    for data, display, said in (
        (window(20, 0, 8, 4), window(0, 0, 16, 8), "outside of its display"),
        (window(0, 9, 8, 4), window(0, 0, 16, 8), "outside of its display"),
        (window(0, 0, 8, 4), window(0, 0, 16000, 8000), "more pixels than"),
    ):
        header = {"dataWindow": data, "displayWindow": display}
        path = save(tmp_path / "a.exr", (header, {"Y": ONES}))
        with pytest.raises(FileError, match=said):
            read_exr(path)


def test_luminance_and_chroma_become_red_green_blue(tmp_path):
    """Y is 0.2126 R + 0.7152 G + 0.0722 B, RY is (R - Y) / Y and BY is (B - Y) / Y."""
    red, green, blue = 0.5, 2.0, 0.25
    y = 0.2126 * red + 0.7152 * green + 0.0722 * blue
    channels = {"Y": ONES * y, "RY": ONES * (red - y) / y, "BY": ONES * (blue - y) / y}
    found = read_exr(save(tmp_path / "a.exr", ({}, channels)))
    np.testing.assert_allclose(found, np.tile([red, green, blue], (4, 8, 1)), rtol=1e-3)


def attribute(name, kind, data):
    return name + b"\0" + kind + b"\0" + struct.pack("<I", len(data)) + data


def test_chroma_of_fewer_pixels_is_refused_by_name(tmp_path):
    """Uncompressed: each row's number, length, and its channels; chroma in every other row."""
    sides = {b"BY": 2, b"RY": 2, b"Y": 1}
    channels = b"".join(
        name + b"\0" + struct.pack("<iiii", 2, 0, side, side) for name, side in sides.items()
    )
    window = struct.pack("<4i", 0, 0, 7, 3)
    head = struct.pack("<II", 20000630, 2) + attribute(b"channels", b"chlist", channels + b"\0")
    head += attribute(b"compression", b"compression", b"\0")
    head += attribute(b"dataWindow", b"box2i", window) + attribute(
        b"displayWindow", b"box2i", window
    )
    head += attribute(b"lineOrder", b"lineOrder", b"\0")
    head += attribute(b"pixelAspectRatio", b"float", struct.pack("<f", 1))
    head += attribute(b"screenWindowCenter", b"v2f", bytes(8))
    head += attribute(b"screenWindowWidth", b"float", struct.pack("<f", 1)) + b"\0"
    rows = [struct.pack("<ii", y, 4 * n) + bytes(4 * n) for y, n in enumerate((16, 8, 16, 8))]
    starts = len(head) + 32 + np.cumsum([0, *map(len, rows[:-1])])
    path = tmp_path / "a.exr"
    path.write_bytes(head + starts.astype("<u8").tobytes() + b"".join(rows))
    with OpenEXR.File(str(path)) as file:
        assert file.channels()["RY"].pixels.shape == (2, 4)  # it is a sound file
    with pytest.raises(FileError, match=r'Subsampled channels .*"BY" has sampling 2,2.*convert it'):
        read_exr(path)


def test_other_chromaticities_are_converted(tmp_path):
    rgb = {"R": 0.9505 * ONES, "G": ONES, "B": 1.089 * ONES}
    xyz = {"chromaticities": (1.0, 0.0, 0.0, 1.0, 0.0, 0.0, 1 / 3, 1 / 3)}
    found = read_exr(save(tmp_path / "xyz.exr", (xyz, rgb)))
    # D65 white in XYZ to four digits.
    np.testing.assert_allclose(found, np.ones((4, 8, 3)), atol=5e-4)
    aces = {"chromaticities": (0.7347, 0.2653, 0.0, 1.0, 0.0001, -0.077, 0.32168, 0.33767)}
    found = read_exr(save(tmp_path / "aces.exr", (aces, {"R": ONES, "G": ONES, "B": ONES})))
    np.testing.assert_allclose(found, np.ones((4, 8, 3)), atol=1e-5)
    # From the matrix that the Academy gives for AP0 to Rec. 709, adapted by Bradford.
    red = np.array([2.5217, -0.2762, -0.0153])
    half = {"R": ONES, "G": ONES / 2, "B": ONES / 2}
    found = read_exr(save(tmp_path / "reddish.exr", (aces, half)))
    np.testing.assert_allclose(2 * found[0, 0] - 1, red, atol=0.02)
    path = save(tmp_path / "red.exr", (aces, {"R": ONES, "G": 0 * ONES, "B": 0 * ONES}))
    with pytest.warns(FileWarning, match=r"100\.00% of its pixels have colours beyond Rec\. 709"):
        found = read_environment_map(path).as_image()
    np.testing.assert_allclose(found[0, 0], np.maximum(red, 0), atol=0.02)
    below = {name: -value for name, value in half.items()}
    found = read_exr(save(tmp_path / "below.exr", (aces, below)))
    np.testing.assert_allclose(-2 * found[0, 0] - 1, red, atol=0.02)
    same = {"chromaticities": (0.64, 0.33, 0.3, 0.6, 0.15, 0.06, 0.3127, 0.329)}
    path = save(tmp_path / "same.exr", (same, {"R": ONES, "G": 0 * ONES, "B": ONES}))
    np.testing.assert_array_equal(read_exr(path)[0, 0], [1, 0, 1])


@pytest.mark.parametrize(
    "chromaticities",
    [
        (0.64, 0.33, 0.3, 0.6, 0.15, 0.06, 0.9, 0.01),
        (0.64, 0.33, 0.3, 0.6, 0.15, 0.06, 0.3, 0.0),
        (0.64, 0.33, 0.64, 0.33, 0.15, 0.06, 0.3, 0.3),
        (np.nan, 0.33, 0.3, 0.6, 0.15, 0.06, 0.3, 0.3),
    ],
)
def test_chromaticities_of_no_colours_are_refused(tmp_path, chromaticities):
    channels = {"R": ONES, "G": ONES, "B": ONES}
    path = save(tmp_path / "a.exr", ({"chromaticities": chromaticities}, channels))
    with pytest.raises(FileError, match="chromaticities must be those of"):
        read_exr(path)


def test_parts_layers_and_views_are_chosen(tmp_path):
    def rgb(value, prefix=""):
        return {prefix + name: value * ONES for name in "RGB"}

    parts = save(
        tmp_path / "a.exr",
        ({"name": "beauty"}, rgb(1)),
        ({"name": "depth"}, {"Z": ONES}),
        ({"name": "diffuse"}, rgb(3)),
    )
    with pytest.warns(FileWarning, match=r"'beauty' was read.*--part\): 'diffuse'"):
        assert read_exr(parts)[0, 0, 0] == 1
    assert read_exr(parts, part="diffuse")[0, 0, 0] == read_exr(parts, part="2")[0, 0, 0] == 3
    with pytest.raises(FileError, match="no part 'specular', but 'beauty', 'diffuse'"):
        read_exr(parts, part="specular")
    views = save(tmp_path / "b.exr", ({"multiView": ["left", "right"]}, rgb(1) | rgb(2, "right.")))
    assert read_exr(views, part="right")[0, 0, 0] == 2
    assert read_exr(views, part="left")[0, 0, 0] == 1
    with pytest.warns(FileWarning, match="'left' was read"):
        assert read_environment_map(views).radiance[0, 0, 0] == 1
    only = save(tmp_path / "c.exr", ({}, rgb(5, "Scene.Combined.")))
    assert read_exr(only)[0, 0, 0] == 5


def test_many_channels_and_deep_pictures_are_refused(tmp_path):
    path = save(tmp_path / "a.exr", ({}, {f"layer{n}.Y": ONES for n in range(129)}))
    with pytest.raises(FileError, match="129 channels; 256 and 128 at most"):
        read_exr(path)
    samples = np.empty((1, 2), object)
    samples[0] = [np.ones(1, "f4"), np.ones(2, "f4")]
    header = {"compression": OpenEXR.ZIPS_COMPRESSION, "type": OpenEXR.deepscanline}
    with OpenEXR.File(header, {"R": samples, "G": samples, "B": samples}) as file:
        file.write(str(tmp_path / "deep.exr"))
    with pytest.raises(FileError, match="deep picture"):
        read_exr(tmp_path / "deep.exr")


def test_a_larger_picture_is_read_if_asked_for(tmp_path):
    write_exr(tmp_path / "a.exr", ONES)
    with pytest.raises(FileError, match="more pixels than the limit of 31"):
        read_exr(tmp_path / "a.exr", max_pixels=31)
    assert read_exr(tmp_path / "a.exr", max_pixels=32).shape == (4, 8)


def test_the_same_picture_is_written_as_the_same_bytes(tmp_path, monkeypatch):
    write_exr(tmp_path / "a.exr", IMAGE)
    assert b"capDate" not in (tmp_path / "a.exr").read_bytes()


def test_reading_changes_nothing_that_other_threads_see(tmp_path, monkeypatch):
    write_exr(tmp_path / "a.exr", IMAGE)
    with monkeypatch.context() as patch, ThreadPoolExecutor(8) as pool:
        patch.setattr(os, "dup2", None)
        patch.setattr(contextlib, "redirect_stdout", None)
        found = list(pool.map(read_exr, [tmp_path / "a.exr"] * 64))
    assert all(np.array_equal(image, IMAGE) for image in found)
