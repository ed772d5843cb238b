import numpy as np
import pytest
from PIL import Image
from scipy.io import savemat

from harmface.conventions import LUMINANCE, linear_to_srgb, srgb_to_linear
from harmface.errors import FileError
from harmface.io import read_capture, read_mask, write_image

SHAPE = (4, 6)


def photograph(path, value, channels=None):
    """Write a small photograph whose codes grow from left to right about a value."""
    codes = np.tile(np.arange(SHAPE[1], dtype=np.uint8) + value, (SHAPE[0], 1))
    if channels is not None:
        codes = np.stack([codes * c for c in channels], axis=-1).astype(np.uint8)
    Image.fromarray(codes).save(path)


def save_mask(path, codes=(0, 255), mode="L"):
    mask = np.zeros(SHAPE, bool)
    mask[1:3, 1:5] = True
    Image.fromarray(np.where(mask, *codes[::-1]).astype(np.uint8)).convert(mode).save(path)
    return mask


def test_a_folder_of_the_washington_set_is_understood(tmp_path):
    for number in range(12):
        photograph(tmp_path / f"cat.{number}.tga", 10 * number)
    mask = save_mask(tmp_path / "cat.mask.tga", mode="RGB")
    photograph(tmp_path / "._cat.0.tga", 0)
    directions = np.linspace([-0.5, 0, 1], [0.5, 0.2, 1], 12)
    np.savetxt(tmp_path / "lights.txt", directions, header="12", comments="")
    found = read_capture([tmp_path])
    assert found.names == tuple(f"cat.{number}.tga" for number in range(12))
    assert np.allclose(found.images[:, 0, 0] * 255, 10 * np.arange(12))
    assert found.images.dtype == np.float32
    assert np.array_equal(found.mask, mask)
    unit = directions / np.linalg.norm(directions, axis=1, keepdims=True)
    assert np.allclose(found.lights, unit)
    assert found.notes[0] == "taken as the mask: cat.mask.tga"
    assert (
        "order of their numbers: cat.0.tga, cat.1.tga, cat.2.tga, ..., cat.11.tga" in found.notes[1]
    )


def test_files_in_the_order_of_a_shell_are_put_in_that_of_numbers_and_others_kept(tmp_path):
    for number in (1, 2, 10):
        photograph(tmp_path / f"img{number}.png", number)
    files = {number: tmp_path / f"img{number}.png" for number in (1, 2, 10)}
    by_shell = read_capture([files[1], files[10], files[2]])
    assert by_shell.names == ("img1.png", "img2.png", "img10.png")
    assert "order of their numbers" in by_shell.notes[0]
    backwards = read_capture([files[10], files[2], files[1]])
    assert backwards.names == ("img10.png", "img2.png", "img1.png")
    assert backwards.notes == ()


def test_masks_and_dark_frames_are_told_from_photographs(tmp_path):
    for name in ("a_1.png", "a_2.png", "a_ambient.png", "dark-01.png"):
        photograph(tmp_path / name, 9)
    mask = save_mask(tmp_path / "a_MASK.png", (0, 1))
    found = read_capture(sorted(tmp_path.iterdir()))
    assert found.names == ("a_1.png", "a_2.png")
    assert np.array_equal(found.mask, mask)
    assert found.notes == (
        "taken as the mask: a_MASK.png",
        "left out as taken without the light: a_ambient.png, dark-01.png",
    )
    save_mask(tmp_path / "other.png", (255, 0))
    given = read_capture(sorted(tmp_path.iterdir()), mask=tmp_path / "other.png")
    assert np.array_equal(given.mask, ~mask)
    assert given.names == found.names
    assert given.notes[0] == "taken as a mask: a_MASK.png, other.png"


def test_intensities_divide_and_colour_becomes_one_channel(tmp_path):
    for number in range(3):
        photograph(tmp_path / f"{number}.png", 20, (1, 2, 4))
    plain = read_capture([tmp_path])
    codes = np.arange(6) + 20
    assert np.allclose(plain.images[0, 0] * 255, codes * np.dot(LUMINANCE, (1, 2, 4)))
    (tmp_path / "lights.txt").write_text("0 0 1 2\n0 0 1 1\n0 0 1 4\n")
    divided = read_capture([tmp_path])
    assert np.allclose(divided.images, plain.images / np.array([2, 1, 4])[:, None, None])
    (tmp_path / "lights.txt").unlink()
    (tmp_path / "light_intensities.txt").write_text("1 2 4\n" * 3)
    even = read_capture([tmp_path])
    assert np.allclose(even.images[0, 0] * 255, codes)
    (tmp_path / "light_intensities.txt").write_text("1 2\n" * 3)
    with pytest.raises(FileError, match="one positive number, or three"):
        read_capture([tmp_path])


def test_srgb_is_undone_on_request_and_jpeg_remarked_on(tmp_path):
    for number in range(3):
        photograph(tmp_path / f"{number}.jpg", 100)
    found = read_capture([tmp_path])
    assert "--gamma srgb" in found.notes[0]
    decoded = read_capture([tmp_path], srgb=True)
    assert decoded.notes == ()
    assert np.allclose(decoded.images, srgb_to_linear(found.images), atol=1e-6)


@pytest.mark.parametrize("said", [True, False])
def test_files_are_believed_unless_the_caller_says_otherwise(tmp_path, said):
    codes = np.linspace(0.1, 0.9, 24).reshape(SHAPE)
    for number in range(3):
        write_image(tmp_path / f"{number}.png", codes * (number + 1) / 3, bits=16, srgb=said)
    stored = np.stack([codes * (number + 1) / 3 for number in range(3)])
    # Half a code of 16 bits, times the steepest slope of the transfer curve.
    atol = 12.92 / 2 / 65535
    np.testing.assert_allclose(read_capture([tmp_path]).images, stored, atol=atol)
    otherwise = read_capture([tmp_path], srgb=not said).images
    change = linear_to_srgb if said else srgb_to_linear
    np.testing.assert_allclose(otherwise, change(stored), atol=atol)


def test_observations_saturated_in_any_channel_are_told(tmp_path):
    expected = np.zeros((4, *SHAPE), bool)
    for number in range(4):
        codes = np.full((*SHAPE, 3), 254, np.uint8)
        codes[number, :, number % 3] = 255
        expected[number, number] = True
        Image.fromarray(codes).save(tmp_path / f"{number}.png")
    (tmp_path / "light_intensities.txt").write_text("2 3 4\n" * 4)
    assert np.array_equal(read_capture([tmp_path]).saturated, expected)


def sphere(lights, size=64):
    """Return photographs, F x H x W in [0, 1], of a white ball under lights of one strength."""
    x, y = np.meshgrid(np.linspace(-1, 1, size), np.linspace(1, -1, size))
    z = np.sqrt(np.maximum(1 - x**2 - y**2, 0))
    shade = np.einsum("fi,ihw->fhw", lights, np.stack([x, y, z])).clip(0)
    return shade * (x**2 + y**2 < 1)


def ring(count=6, tilt=0.5):
    angle = 2 * np.pi * np.arange(count) / count
    height = np.full(count, np.cos(tilt))
    return np.stack([np.sin(tilt) * np.cos(angle), np.sin(tilt) * np.sin(angle), height], axis=1)


def save_codes(folder, images, full):
    folder.mkdir(exist_ok=True)
    for number, image in enumerate(images):
        codes = np.clip(image * full, 0, full).astype(np.uint16)
        Image.fromarray(codes).save(folder / f"{number}.tif")
    return folder


@pytest.mark.parametrize("full", [4095, 16383])
def test_a_common_code_below_full_scale_is_where_photographs_are_clipped(tmp_path, full):
    images = 1.9 * sphere(ring())
    found = read_capture([save_codes(tmp_path / "a", images, full)])
    twin = read_capture([save_codes(tmp_path / "b", images, 65535)])
    np.testing.assert_array_equal(twin.saturated, images >= 1)
    # A code of the coarser file is 1 / full of its range.
    np.testing.assert_array_equal(found.saturated, images >= 1)
    (note,) = found.notes
    share = f"{(images >= 1).mean():.1%}"
    assert note.startswith(f"the photographs are clipped at {full}, below the largest code")
    assert f"65535: {share} of the observations are taken as saturated" in note
    assert twin.notes == ()


@pytest.mark.parametrize("strength", [0.3, 0.9])
@pytest.mark.parametrize("full", [255, 4095, 65535])
def test_photographs_that_are_not_clipped_are_left_alone(tmp_path, strength, full):
    """All have the same largest code, where a ball faces the light, in a flat maximum."""
    found = read_capture([save_codes(tmp_path / "a", strength * sphere(ring(), 200), full)])
    assert not found.saturated.any()
    assert found.notes == ()
    flat = np.full((3, 4, 6), 0.5) * (np.arange(4)[:, None] > 0)
    assert not read_capture([save_codes(tmp_path / "b", flat, full)]).saturated.any()


def test_lights_are_found_one_folder_up(tmp_path):
    folder = tmp_path / "photos"
    folder.mkdir()
    for number in range(3):
        photograph(folder / f"{number}.png", 9)
    lights = np.array([[0.6, 0, 0.8], [0, 0.6, 0.8], [0, 0, 1]])
    np.savetxt(tmp_path / "lights.txt", lights)
    found = read_capture([folder])
    np.testing.assert_allclose(found.lights, lights)
    assert found.notes == (f"the lights are those of {tmp_path / 'lights.txt'}",)
    np.savetxt(tmp_path / "lights.txt", np.ones((7, 3)))
    found = read_capture([folder])
    assert found.lights is None
    assert "lights beside the folder are not used" in found.notes[0]
    np.savetxt(folder / "lights.txt", np.ones((7, 3)))
    with pytest.raises(FileError, match="holds 7 lines"):
        read_capture([folder])


def test_a_file_of_rti_names_its_photographs(tmp_path):
    for number in range(3):
        photograph(tmp_path / f"{number}.png", 9)
    (tmp_path / "set.lp").write_text("3\n2.jpg 0 0 1\n0.jpg 0.6 0 0.8\n1.jpg 0 0.6 0.8\n")
    expected = [[0.6, 0, 0.8], [0, 0.6, 0.8], [0, 0, 1]]
    np.testing.assert_allclose(read_capture([tmp_path]).lights, expected)
    (tmp_path / "other.lp").write_text("3\n")
    with pytest.raises(FileError, match="second file of lights"):
        read_capture([tmp_path])


def test_photographs_are_turned_with_their_mask(tmp_path):
    exif = Image.Exif()
    exif[0x112] = 6
    codes = np.arange(24, dtype=np.uint8).reshape(SHAPE)
    for number in range(3):
        Image.fromarray(codes).save(tmp_path / f"{number}.png", exif=exif)
    Image.fromarray(np.full(SHAPE, 255, np.uint8)).save(tmp_path / "mask.png", exif=exif)
    found = read_capture([tmp_path])
    np.testing.assert_allclose(found.images[0] * 255, np.rot90(codes, -1), rtol=1e-6)
    assert found.mask.shape == (6, 4)


def test_a_set_too_large_for_memory_is_refused_before_it_is_taken(tmp_path):
    for number in range(17):
        photograph(tmp_path / f"{number:02}.png", 9)
    with pytest.raises(FileError, match="16 more have 6 x 4 pixels each, more than 16 times 24"):
        read_capture([tmp_path], max_pixels=24)
    assert len(read_capture([tmp_path], max_pixels=26).images) == 17


def test_lists_of_names_are_checked(tmp_path):
    photograph(tmp_path / "a b.png", 9)
    (tmp_path / "filenames.txt").write_text("a b.png\n")
    assert read_capture([tmp_path]).names == ("a b.png",)
    for text in ("../a.png", "a\0b.png", "\n", "x" * 5000 + "/y", "\0" * 190):
        (tmp_path / "filenames.txt").write_text(text)
        with pytest.raises(FileError, match="plain file names") as error:
            read_capture([tmp_path])
        assert len(str(error.value)) < 400


def test_normals_of_a_matlab_file_are_the_truth(tmp_path, rng):
    for number in range(3):
        photograph(tmp_path / f"{number}.png", 9)
    normals = rng.normal(size=(*SHAPE, 3))
    savemat(tmp_path / "Normal_gt.mat", {"Normal_gt": normals})
    np.testing.assert_array_equal(read_capture([tmp_path]).truth, normals)
    for wrong in (normals[1:], normals * np.nan):
        savemat(tmp_path / "Normal_gt.mat", {"Normal_gt": wrong})
        with pytest.raises(FileError, match="4 x 6 x 3 as the photographs are"):
            read_capture([tmp_path])


def test_reading_reports_its_progress(tmp_path):
    for number in range(4):
        photograph(tmp_path / f"{number}.png", 9)
    done = []
    read_capture([tmp_path], report=done.append)
    assert done == [0.25, 0.5, 0.75, 1]


def test_what_cannot_be_a_set_is_refused(tmp_path):
    for number in range(3):
        photograph(tmp_path / f"{number}.png", 9)
    files = sorted(tmp_path.iterdir())
    save_mask(tmp_path / "outline.png")
    with pytest.raises(FileError, match=r"outline.png: is black and white only"):
        read_capture([*files, tmp_path / "outline.png"])
    save_mask(tmp_path / "a.mask.png")
    save_mask(tmp_path / "b.mask.png")
    with pytest.raises(FileError, match=r"b.mask.png: is a second mask beside a.mask.png"):
        read_capture([*files, tmp_path / "a.mask.png", tmp_path / "b.mask.png"])
    with pytest.raises(FileError, match="no photograph by its name"):
        read_capture([tmp_path / "a.mask.png"])
    write_image(tmp_path / "large.png", np.ones((9, 9)))
    for arguments in ({"mask": tmp_path / "large.png"}, {}):
        with pytest.raises(FileError, match=r"large.png: has 9 x 9 pixels, 0.png has 4 x 6"):
            read_capture(files if arguments else [*files, tmp_path / "large.png"], **arguments)
    write_image(tmp_path / "black.png", np.zeros(SHAPE))
    with pytest.raises(FileError, match=r"black.png: is an empty mask"):
        read_mask(tmp_path / "black.png")


def test_a_listed_set_keeps_its_order(tmp_path):
    for number in (1, 2, 10):
        photograph(tmp_path / f"{number}.png", number)
    (tmp_path / "filenames.txt").write_text("10.png\n1.png\n2.png\n")
    assert read_capture([tmp_path]).names == ("10.png", "1.png", "2.png")


def test_channels_are_photographs_under_coloured_lamps(tmp_path):
    for number in range(2):
        photograph(tmp_path / f"{number}.png", 40 - 20 * number, (1, 2, 4))
    codes = np.arange(6) + 40
    found = read_capture([tmp_path], coloured=True)
    assert found.names[:4] == ("0.png red", "0.png green", "0.png blue", "1.png red")
    assert np.allclose(found.images[:3, 0] * 255, [codes, 2 * codes, 4 * codes])
    directions = np.eye(3)[[0, 1, 2, 2, 1, 0]] + (0, 0, 0.5)
    np.savetxt(tmp_path / "lights.txt", directions)
    unit = directions / np.linalg.norm(directions, axis=1, keepdims=True)
    assert np.allclose(read_capture([tmp_path], coloured=True).lights, unit)
    with pytest.raises(FileError, match="6 lines of 3 numbers, but 2 images"):
        read_capture([tmp_path])
    photograph(tmp_path / "2.png", 9)
    (tmp_path / "lights.txt").unlink()
    with pytest.raises(FileError, match=r"2\.png: is grey, but lamps of three colours"):
        read_capture([tmp_path], coloured=True)


def test_a_channel_at_full_scale_is_saturated_alone_under_coloured_lamps(tmp_path):
    codes = np.full((*SHAPE, 3), 90, np.uint8)
    codes[1, 2, 1] = 255
    codes[..., 0] -= np.arange(6, dtype=np.uint8)
    Image.fromarray(codes).save(tmp_path / "a.png")
    found = read_capture([tmp_path], coloured=True)
    assert np.argwhere(found.saturated).tolist() == [[1, 1, 2]]
