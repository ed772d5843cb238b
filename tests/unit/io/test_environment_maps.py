import numpy as np
import pytest
from PIL import Image

from harmface.conventions import linear_to_srgb, map_frame, srgb_to_linear
from harmface.errors import ArgumentError, FileError, FileWarning
from harmface.io.environment_maps import read_environment_map, write_environment_map
from harmface.io.images import write_image
from harmface.io.pfm import read_pfm, write_pfm
from harmface.io.radiance_hdr import read_radiance_hdr, write_radiance_hdr
from harmface.light import LAYOUTS, faces_from_opengl
from harmface.light.layouts import RH01Probe

IMAGE = np.random.default_rng(7).gamma(0.5, size=(8, 16, 3)).astype(np.float32)
HEADER = "#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y {} +X {}\n"
# A pixel's largest channel has 128 to 255 of its exponent's steps: half a step is 1/256 of it.
RGBE_STEP = 1 / 256


@pytest.fixture
def hdr(tmp_path):
    path = tmp_path / "map.hdr"
    write_radiance_hdr(path, IMAGE)
    return path


def test_radiance_pictures_come_back_to_their_precision(hdr):
    found = read_radiance_hdr(hdr)
    assert found.dtype == np.float32
    assert (np.abs(found - IMAGE).max(axis=-1) <= RGBE_STEP * IMAGE.max(axis=-1)).all()
    # Rounded, not cut off: no light is lost on the whole. The mean of 384 errors, each uniform.
    assert abs((found - IMAGE).mean()) < 5 * RGBE_STEP * IMAGE.max(axis=-1).mean() / np.sqrt(384)


def test_colours_keep_their_order(tmp_path):
    path = tmp_path / "red.hdr"
    write_radiance_hdr(path, np.tile(np.array([1.0, 0.5, 0.25]), (2, 4, 1)))
    np.testing.assert_array_equal(read_radiance_hdr(path)[1, 2], [1.0, 0.5, 0.25])


def test_exposures_of_the_header_are_divided_out(hdr):
    plain = read_radiance_hdr(hdr)
    data = hdr.read_bytes().replace(b"FORMAT", b"EXPOSURE=2\nEXPOSURE=4\nFORMAT", 1)
    hdr.write_bytes(data)
    np.testing.assert_array_equal(read_radiance_hdr(hdr), plain / 8)


def test_grey_is_written_as_three_equal_channels(tmp_path):
    path = tmp_path / "grey.hdr"
    write_radiance_hdr(path, np.full((2, 4), 0.5))
    np.testing.assert_array_equal(read_radiance_hdr(path), np.full((2, 4, 3), 0.5))


@pytest.mark.parametrize(
    ("old", "new", "said"),
    [
        (b"32-bit_rle_rgbe", b"24-bit_rgb", "holds 24-bit_rgb"),
        (b"FORMAT", b"FORMAT=32-bit_rle_xyze\nFORMAT", "rgbe, 32|xyze, 32"),
        (b"-Y 8 +X 16", b"-Y 8 +Y 16", "size line"),
        (b"-Y 8 +X 16", b"-Y 8", "size line"),
        (b"-Y 8 +X 16", b"-Y 0 +X 16", "16 x 0 pixels"),
        (b"-Y 8 +X 16", b"-Y 316227 +X 316228", "316228 x 316227 pixels"),
        (b"-Y 8 +X 16", b"-Y 8000 +X 16000", "more pixels than|cut off"),
        (b"-Y 8 +X 16", b"-Y 9 +X 16", "cut off"),
        (b"FORMAT", b"EXPOSURE=-1\nFORMAT", "EXPOSURE"),
        (b"FORMAT", b"COLORCORR=1 1\nFORMAT", "COLORCORR"),
        (b"FORMAT", b"PRIMARIES=1 2 3\nFORMAT", "PRIMARIES"),
        (b"FORMAT", b"PRIMARIES=.3 .3 .3 .3 .3 .3 .3 .3\nFORMAT", "PRIMARIES"),
        (b"FORMAT", b"EXPOSURE=bright\nFORMAT", "EXPOSURE"),
        (b"FORMAT", b"EXPOSURE=nan\nFORMAT", "EXPOSURE"),
    ],
)
def test_headers_that_lie_are_refused(hdr, old, new, said):
    data = hdr.read_bytes()
    assert old in data
    hdr.write_bytes(data.replace(old, new, 1))
    with pytest.raises(FileError, match=said):
        read_radiance_hdr(hdr)


@pytest.mark.parametrize("size", [(100_000, 1_000_000), (2**14, 2**14)])
def test_headers_of_many_gigapixels_take_no_memory(tmp_path, size):
    path = tmp_path / "huge.hdr"
    path.write_bytes(HEADER.format(*size).encode() + bytes(1000))
    with pytest.raises(FileError, match="pixels"):
        read_radiance_hdr(path)


@pytest.mark.parametrize("share", [0.0, 0.1, 0.5, 0.9, 0.999])
def test_cut_off_pictures_are_refused_silently(hdr, share, capfd):
    data = hdr.read_bytes()
    hdr.write_bytes(data[: int(share * len(data))])
    with pytest.raises(FileError, match=r"map\.hdr"):
        read_radiance_hdr(hdr)
    assert capfd.readouterr() == ("", "")


@pytest.mark.parametrize("suffix", [".hdr", ".pfm"])
def test_damaged_files_raise_file_errors_only(tmp_path, suffix, capfd):
    path = tmp_path / f"map{suffix}"
    write_environment_map(path, IMAGE)
    data = path.read_bytes()
    rng = np.random.default_rng(1)
    refused = 0
    for _ in range(200):
        damaged = bytearray(data)
        for place in rng.integers(0, len(data), rng.integers(1, 8)):
            damaged[place] ^= 1 << rng.integers(8)
        for place in rng.integers(0, 80, rng.integers(0, 2)):
            damaged[place] = rng.integers(256)
        path.write_bytes(damaged[: rng.integers(1, 2 * len(data))])
        try:
            read_environment_map(path)
        except FileError as error:
            assert "\n" not in str(error)
            refused += 1
    assert 30 < refused < 200
    assert capfd.readouterr() == ("", "")


@pytest.mark.parametrize(
    ("image", "said"),
    [
        (-IMAGE, "negative"),
        (np.full((2, 4), np.nan), "finite"),
        (np.full((2, 4), 2.0**126), r"2\*\*126"),
        (np.ones((2, 4, 2)), "shape"),
        (np.ones((0, 4)), "shape"),
    ],
)
def test_what_radiance_pictures_cannot_hold_is_refused(unchecked, tmp_path, image, said):
    path = tmp_path / "out.hdr"
    with pytest.raises(ArgumentError, match=said):
        write_radiance_hdr(path, image)
    assert not path.exists()


@pytest.mark.parametrize("image", [IMAGE - 1, IMAGE[..., 0]])
def test_float_maps_come_back_exactly(tmp_path, image):
    path = tmp_path / "map.pfm"
    write_pfm(path, image)
    np.testing.assert_array_equal(read_pfm(path), image)


def test_float_maps_start_with_the_bottom_row_in_either_byte_order(tmp_path):
    path = tmp_path / "map.pfm"
    values = np.array([[1, 2], [3, 4]], ">f4")
    path.write_bytes(b"Pf\n2 2\n1.0\n" + values.tobytes())
    np.testing.assert_array_equal(read_pfm(path), [[3, 4], [1, 2]])


@pytest.mark.parametrize(
    ("data", "said"),
    [
        (b"P6\n1 1\n255\nabc", "header"),
        (b"Pf\n2 2\n-1.0\n" + bytes(15), "15 follow"),
        (b"Pf\n2 2\n-1.0\n" + bytes(17), "17 follow"),
        (b"Pf\n0 2\n-1.0\n", "0 x 2"),
        (b"Pf\n1 1\n-e\n" + bytes(4), "scale"),
        (b"Pf\n999999999 999999999\n-1\n" + bytes(4), "999999999"),
    ],
)
def test_broken_float_maps_are_refused(tmp_path, data, said):
    path = tmp_path / "map.pfm"
    path.write_bytes(data)
    with pytest.raises(FileError, match=said):
        read_pfm(path)


@pytest.mark.parametrize("image", [np.full((2, 4), np.inf), np.ones((2, 4, 2)), np.ones((2, 0))])
def test_what_float_maps_cannot_hold_is_refused(unchecked, tmp_path, image):
    with pytest.raises(ArgumentError, match="image"):
        write_pfm(tmp_path / "out.pfm", image)


def test_maps_are_read_with_their_layout_and_frame(hdr):
    environment = read_environment_map(hdr, frame="three.js")
    assert (environment.layout, environment.height) == (LAYOUTS["latlong"], 8)
    np.testing.assert_array_equal(environment.as_image(), read_radiance_hdr(hdr))
    np.testing.assert_array_equal(environment.frame, map_frame("latlong", "three.js"))


def test_srgb_is_undone_on_request(tmp_path):
    path = tmp_path / "map.png"
    Image.fromarray(np.full((2, 4, 3), 128, np.uint8)).save(path)
    with pytest.warns(FileWarning, match="8 bits, which are taken as linear"):
        encoded = read_environment_map(path).radiance
    np.testing.assert_array_equal(read_environment_map(path, srgb=False).radiance, encoded)
    linear = read_environment_map(path, srgb=True).radiance
    np.testing.assert_allclose(encoded, 0.5, atol=0.5 / 255)
    np.testing.assert_array_equal(linear, srgb_to_linear(encoded))
    # What a file says of itself is believed, and nothing needs to be asked.
    for srgb in (False, True):
        write_image(path, np.full((2, 4, 3), 0.5), bits=8, srgb=srgb)
        np.testing.assert_allclose(read_environment_map(path).radiance, 0.5, atol=0.005)
    # But the caller knows better.
    told = read_environment_map(path, srgb=False).radiance
    np.testing.assert_allclose(told, linear_to_srgb(np.array(0.5)), atol=0.005)


def test_srgb_of_linear_files_is_refused(hdr):
    with pytest.raises(FileError, match="linear"):
        read_environment_map(hdr, srgb=True)


@pytest.mark.parametrize("frame", ["openexr", "opengl", "three.js"])
@pytest.mark.parametrize("arrangement", ["vertical-strip", "horizontal-cross"])
def test_cubes_show_what_their_frame_says(tmp_path, arrangement, frame):
    """A cube that holds its own directions, made in each frame, is read back as the directions."""
    path = tmp_path / "cube.pfm"
    world = LAYOUTS["cube"].directions(4) @ map_frame("cube", frame).T
    theirs = world if frame == "openexr" else faces_from_opengl(world)
    if frame != "openexr" and arrangement == "horizontal-cross":
        theirs = theirs[[0, 1, 2, 3, 5, 4]]
    write_environment_map(path, 1 + theirs, arrangement=arrangement)
    environment = read_environment_map(path, "cube", frame=frame)
    np.testing.assert_allclose(environment.as_image(), 1 + environment.directions, atol=1e-6)


def test_cubes_are_read_from_six_files(tmp_path):
    faces = np.random.default_rng(0).random((6, 4, 4, 3)).astype(np.float32)
    paths = [tmp_path / f"{number}.pfm" for number in range(6)]
    for path, face in zip(paths, faces, strict=True):
        write_pfm(path, face)
    np.testing.assert_array_equal(read_environment_map(paths, "cube").as_image(), faces)
    write_pfm(paths[3], faces[3, :3, :3])
    with pytest.raises(FileError, match=r"3\.pfm: a cube's faces have one size"):
        read_environment_map(paths, "cube")
    with pytest.raises(FileError, match="six faces, got 5"):
        read_environment_map(paths[:5], "cube")
    with pytest.raises(FileError, match="one file, got 6"):
        read_environment_map(paths, "latlong")


@pytest.mark.parametrize(
    ("shape", "layout", "said"),
    [
        ((8, 8, 3), "latlong", "twice as wide"),
        ((8, 16, 3), "angular", "square"),
        ((8, 16, 3), "cube", "neither a cross"),
        ((24, 4, 3), "latlong", "twice as wide"),
    ],
)
def test_maps_of_another_layout_are_noticed_by_their_shape(tmp_path, shape, layout, said):
    path = tmp_path / "map.pfm"
    write_pfm(path, np.ones(shape))
    with pytest.raises(FileError, match=rf"map\.pfm: .*{said}"):
        read_environment_map(path, layout)


@pytest.mark.parametrize("layout", ["angular", "mirror-ball"])
def test_squares_with_lit_corners_are_no_discs(tmp_path, layout):
    path = tmp_path / "map.pfm"
    image = np.ones((16, 16))
    write_pfm(path, image)
    with pytest.raises(FileError, match="corners"):
        read_environment_map(path, layout)
    image[LAYOUTS[layout].solid_angles(16) == 0] = 0
    write_pfm(path, image)
    assert read_environment_map(path, layout).height == 16


def test_angular_files_are_read_as_rh01_did_unless_they_say_otherwise(tmp_path):
    path = tmp_path / "probe.pfm"
    image = np.ones((16, 16))
    image[LAYOUTS["angular"].solid_angles(16) == 0] = 0
    write_pfm(path, image)
    for frame in (None, "rh01"):
        assert isinstance(read_environment_map(path, "angular", frame=frame).layout, RH01Probe)
    for frame in ("figure-3", "debevec"):
        found = read_environment_map(path, "angular", frame=frame)
        assert not isinstance(found.layout, RH01Probe)


@pytest.mark.parametrize("value", [-1.0, np.nan, np.inf])
def test_radiance_that_cannot_be_is_refused(tmp_path, value):
    path = tmp_path / "map.pfm"
    values = np.ones((2, 4), "<f4")
    values[1, 2] = value
    path.write_bytes(b"Pf\n4 2\n-1.0\n" + values.tobytes())
    with pytest.raises(FileError, match=r"map\.pfm: radiance"):
        read_environment_map(path)


def test_names_are_checked_before_files(tmp_path):
    with pytest.raises(FileError, match="does not exist"):
        read_environment_map(tmp_path / "none.hdr")
    with pytest.raises(ArgumentError, match="layout"):
        read_environment_map(tmp_path / "none.hdr", "octahedral")
    with pytest.raises(ArgumentError, match="frame"):
        read_environment_map(tmp_path / "none.hdr", frame="opengl")
    with pytest.raises(FileError, match=r"end in \.hdr"):
        write_environment_map(tmp_path / "map.bmp", IMAGE)
