import numpy as np
import pytest

from harmface.errors import ArgumentError
from harmface.geometry import Mesh, OrthographicCamera, PerspectiveCamera, Texture, gbuffer
from harmface.geometry.texture import TextureImage

SQUARE = np.array([[0.0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]])
FACES = np.array([[0, 1, 2], [0, 2, 3]])
UP = np.tile([0.0, 0, 1], (4, 1))
WHITE = np.ones((4, 3))


def square(*images, image=(0, 0), uv=SQUARE[:, :2], tint=WHITE, albedo=WHITE):
    texture = Texture(tuple(images), np.array(image), uv, tint)
    return Mesh(SQUARE, FACES, UP, albedo, texture)


def grey(codes):
    return np.asarray(codes)[..., None].repeat(3, axis=2)


def test_pixel_centres_lie_at_half_integers_and_v_runs_upwards():
    image = TextureImage(grey([[0.1, 0.2], [0.3, 0.4]]))
    uv = np.array([[0.25, 0.75], [0.75, 0.75], [0.25, 0.25], [0.75, 0.25], [0.5, 0.5], [0.5, 0.75]])
    assert np.allclose(image.sample(uv)[:, 0], [0.1, 0.2, 0.3, 0.4, 0.25, 0.15])


@pytest.mark.parametrize(
    ("wrap", "values"),
    [("repeat", [1.5, 0, 3, 3]), ("mirror", [0, 3, 0, 3]), ("clamp", [0, 3, 0, 0])],
)
def test_beyond_the_edges_lies_what_wrap_says(wrap, values):
    image = TextureImage(grey(np.array([[0, 1, 2, 3]]) / 4), wrap=(wrap, "clamp"))
    # At the left edge, and at the centres of the pixels right of the last, left of the first,
    # and left of the first a period earlier.
    uv = np.array([[0.0, 0.5], [1.125, 0.5], [-0.125, 0.5], [-1.125, 0.5]])
    assert np.allclose(image.sample(uv)[:, 0] * 4, values)


@pytest.mark.parametrize("dtype", [np.uint8, np.uint16, np.float64])
def test_srgb_is_undone_before_values_are_mixed(dtype):
    top = 1 if dtype is np.float64 else np.iinfo(dtype).max
    image = TextureImage(grey(np.array([[0, top]], dtype)), srgb=True, wrap=("clamp", "clamp"))
    assert np.allclose(image.sample(np.array([[0.5, 0.5]])), 0.5)
    assert np.allclose(image.sample(np.array([[0.5, 0.5]]), np.array([2.0])), 0.5)


@pytest.mark.parametrize("size", [16, 13])
def test_a_large_footprint_means_the_mean(size, rng):
    pixels = rng.random((size, size, 3))
    found = TextureImage(pixels).sample(np.array([[0.3, 0.6]]), np.array([1e9]))
    # An odd last row or column counts twice in each of the means of means.
    tolerance = 1e-6 if size == 16 else 0.1
    assert np.allclose(found, pixels.mean(axis=(0, 1)), atol=tolerance)


def test_blocks_are_averaged_where_a_sample_stands_for_many_pixels():
    checks = (np.indices((256, 256)).sum(axis=0) % 2 * 255).astype(np.uint8)
    mesh = square(TextureImage(grey(checks), srgb=False))
    for camera in (
        OrthographicCamera((0.5, 0.5, 1.0), 1.0, (16, 16)),
        PerspectiveCamera((0.5, 0.5, 1.0), 2 * np.degrees(np.arctan(0.5)), (16, 16)),
    ):
        view = gbuffer(mesh, camera)
        assert view.mask.all()
        assert np.allclose(view.albedo, 0.5, atol=1e-6)
    fine = gbuffer(mesh, OrthographicCamera((0.5, 0.5, 1.0), 1.0, (256, 256)))
    assert np.allclose(fine.albedo[..., 0] * 255, checks, atol=1)


def test_faces_have_pictures_of_their_own_or_the_vertices_albedo():
    one = TextureImage(np.full((1, 1, 3), 51, np.uint8))
    other = TextureImage(np.full((1, 1, 3), 102, np.uint8))
    camera = OrthographicCamera((0.5, 0.5, 1.0), 1.0, (8, 8))
    tint = np.full((4, 3), (1, 0.5, 0.25))
    two = gbuffer(square(one, other, image=(1, 0), tint=tint), camera)
    bare = gbuffer(square(one, image=(-1, 0), albedo=np.full((4, 3), 0.7)), camera)
    # The first face lies below the diagonal that runs upwards.
    assert np.allclose(two.albedo[7, 5], [0.4, 0.2, 0.1])
    assert np.allclose(two.albedo[1, 2], [0.2, 0.1, 0.05])
    assert np.allclose(bare.albedo[7, 5], 0.7)
    assert np.allclose(bare.albedo[1, 2], 0.2)


def test_supersampling_averages_the_finer_picture_and_leaves_the_background_out():
    image = TextureImage(np.random.default_rng(0).random((8, 8, 3)))
    mesh = square(image)
    coarse = gbuffer(mesh, OrthographicCamera((0.6, 0.5, 1.0), 2.0, (10, 10)), 2)
    fine = gbuffer(mesh, OrthographicCamera((0.6, 0.5, 1.0), 2.0, (20, 20)))
    blocks = fine.albedo.reshape(10, 2, 10, 2, 3).sum(axis=(1, 3))
    hits = fine.mask.reshape(10, 2, 10, 2).sum(axis=(1, 3))
    assert np.allclose(coarse.albedo[coarse.mask], blocks[coarse.mask] / hits[coarse.mask][:, None])
    assert not coarse.albedo[~coarse.mask].any()


def test_rotation_and_turning_inside_out_keep_the_texture():
    mesh = square(TextureImage(np.full((1, 1, 3), 51, np.uint8)))
    quarter = np.array([[0.0, -1, 0], [1, 0, 0], [0, 0, 1]])
    assert mesh.rotated(quarter).texture is mesh.texture
    flipped = mesh.flipped()
    assert flipped.texture is mesh.texture
    assert np.array_equal(flipped.normals, -UP)
    assert np.array_equal(flipped.faces, FACES[:, ::-1])


@pytest.mark.parametrize(
    ("pixels", "message"),
    [
        (np.zeros((2, 2)), r"shape \(H, W, 3\)"),
        (np.zeros((0, 2, 3)), r"shape \(H, W, 3\)"),
        (np.full((1, 1, 3), 2.0), "up to 2"),
        (np.full((1, 1, 3), np.nan), "finite"),
        (np.full((1, 1, 3), 2, np.int32), "int32"),
    ],
)
def test_pictures_that_are_none_are_refused(unchecked, pixels, message):
    with pytest.raises(ArgumentError, match=message):
        TextureImage(pixels)


def test_unknown_wraps_are_refused():
    with pytest.raises(ArgumentError, match="wrap must be of repeat, mirror, clamp"):
        TextureImage(np.zeros((1, 1, 3)), wrap=("repeat", "tile"))


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"image": (0, 1)}, "must index 1 images"),
        ({"image": (0, -2)}, "must index 1 images"),
        ({"image": (0,)}, "for .4, 4, 2. vertices"),
        ({"uv": SQUARE[:3, :2]}, "for .4, 4, 2. vertices"),
        ({"uv": SQUARE[:, :2] * np.nan}, "uv must be finite"),
        ({"tint": WHITE * 2}, "tint must lie"),
        ({"tint": -WHITE}, "tint must not be negative"),
    ],
)
def test_textures_that_do_not_fit_are_refused(unchecked, change, message):
    with pytest.raises(ArgumentError, match=message):
        square(TextureImage(np.zeros((1, 1, 3))), **change)
