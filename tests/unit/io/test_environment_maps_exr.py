import numpy as np
import OpenEXR
import pytest

from harmface.errors import ArgumentError, FileError
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
    with pytest.raises(FileError, match=r"100000 x 1000000 pixels|whole OpenEXR"):
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


def test_lost_pixels_are_told_in_the_words_that_the_library_prints(tmp_path):
    path = tmp_path / "map.exr"
    write_exr(path, IMAGE)
    data = bytearray(path.read_bytes())
    # The table of the one chunk's place ends where the chunk starts, with its row and its length.
    start = next(n for n in range(8, len(data)) if int.from_bytes(data[n - 8 : n], "little") == n)
    data[start : start + 4] = (5).to_bytes(4, "little")
    path.write_bytes(data)
    with pytest.raises(FileError, match="Warning"):
        read_exr(path)


@pytest.mark.parametrize("image", [np.full((2, 4), np.inf), np.ones((2, 4, 2)), np.ones((2, 0))])
def test_what_is_no_picture_is_refused(unchecked, tmp_path, image):
    with pytest.raises(ArgumentError, match="image"):
        write_exr(tmp_path / "out.exr", image)


def test_missing_files_are_named(tmp_path):
    with pytest.raises(FileError, match="does not exist"):
        read_exr(tmp_path / "none.exr")
