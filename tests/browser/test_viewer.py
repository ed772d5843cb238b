import re
from dataclasses import replace

import numpy as np
import pytest
from scipy.ndimage import binary_dilation, binary_erosion
from scipy.spatial.transform import Rotation

from data_synth.shapes.radial import ellipsoid
from harmface.conventions import LUMINANCE, linear_to_srgb
from harmface.geometry import depth_to_mesh, frame_orthographic, gbuffer
from harmface.io import read_coefficients
from harmface.light import EnvironmentMap, layout_named, published_probe, sample
from harmface.rendering import (
    harmonic_irradiance,
    irradiance_matrix,
    matrix_irradiance,
)
from harmface.reproduce.synthetic import mesh_of
from harmface.sphere import rotate
from harmface.viz import viewer
from harmface.viz.harmonics import SIGNED

CODE = 1 / 255
STEP = 5
"""Degrees that an arrow key turns by."""

RIM = 0.3
"""Cosine of the angle to the viewer, 73 degrees, beyond which pixels are not compared."""

GRACE = published_probe("grace")


@pytest.fixture(scope="module")
def egg():
    """A smooth convex object, painted smoothly: no pixel but its outline's sees two surfaces."""
    mesh = mesh_of(ellipsoid(resolution=64))
    places = (mesh.vertices - mesh.bounds[0]) / np.ptp(mesh.bounds, axis=0)
    return replace(mesh, albedo=0.3 + 0.6 * places)


def views(mesh, shape, turn=None):
    """Return what the page's camera sees of a mesh turned about its middle, and what is beside it.

    A rasteriser puts each vertex on a grid, here of 1/16 of a pixel (its SUBPIXEL_BITS are 4): it
    shows what lies up to that far to each side.
    """
    centred = replace(mesh, vertices=mesh.vertices - mesh.bounds.mean(axis=0))
    camera = frame_orthographic(centred, shape)
    turned = centred if turn is None else centred.rotated(turn)
    offset = camera.height / shape[0] / 16
    return [
        gbuffer(turned, replace(camera, center=(x * offset, y * offset, 10 * camera.height)))
        for x, y in ((0, 0), (-1, 0), (1, 0), (0, -1), (0, 1))
    ]


def radiosity(view, light, painted=True):
    """Return albedo times E = n^T M n, channels last."""
    received = matrix_irradiance(irradiance_matrix(light), view.normals[view.mask]).T
    image = np.zeros(view.normals.shape)
    image[view.mask] = received * (view.albedo[view.mask] if painted else 1)
    return image


def in_picture(image, exposure):
    return linear_to_srgb(np.clip(exposure * image, 0, 1))


def in_signed_colours(image, exposure):
    stops = np.linspace(-1, 1, 5)
    value = np.clip(exposure * image @ np.array(LUMINANCE), -1, 1)
    colours = SIGNED.resampled(5)(np.arange(5))[:, :3]
    return np.stack([np.interp(value, stops, channel) for channel in colours.T], axis=-1)


def assert_shown(shown, seen, expected):
    """Check a picture against what `expected` makes of a view, wherever that is certain.

    Left out are the rim, where the page's antialiasing mixes the object with its surroundings and
    triangles are foreshortened to slivers that the rasteriser's grid bends, and what changes by a
    quarter of a code along one step of that grid.
    """
    right, *beside = map(expected, seen)
    inside = binary_erosion(seen[0].mask)
    steady = np.abs(np.array(beside) - right).max(axis=(0, -1)) < CODE / 4
    certain = inside & steady & (seen[0].normals[..., 2] > RIM)
    assert certain.sum() > max(20_000, 0.5 * inside.sum())
    assert np.abs(shown - right)[certain].max() <= CODE


def assert_lit(page, mesh, light, turn=None, *, painted=True):
    """Check that a page shows a mesh under a light, at the exposure it tells."""
    shown, exposure = page.picture(), page.state()["exposure"]
    assert_shown(
        shown,
        views(mesh, shown.shape[:2], turn),
        lambda view: in_picture(radiosity(view, light, painted), exposure),
    )


def nine(page):
    return np.array(page.state()["coefficients"])[:, :9]


def turned_by(axes, *angles):
    return Rotation.from_euler(axes, angles, degrees=True).as_matrix()


def test_each_coefficient_alone(show, egg):
    page = show(viewer(egg).html)
    for k in range(9):
        page.page.locator("#sliders button").nth(k).click()
        light = np.tile(np.eye(9)[k], (3, 1))
        np.testing.assert_allclose(nine(page), light, atol=1e-12)
        shown, exposure = page.picture(), page.state()["exposure"]
        seen = views(egg, shown.shape[:2])
        largest = np.abs(radiosity(seen[0], light) @ np.array(LUMINANCE)).max()
        assert 0.9 < exposure * largest < 1.1
        assert_shown(shown, seen, lambda view: in_signed_colours(radiosity(view, light), exposure))  # noqa: B023
        page.choose("ways", "picture")
        assert_lit(page, egg, light)


def test_the_row_of_grace(show, egg):
    page = show(viewer(egg, GRACE).html)
    np.testing.assert_allclose(nine(page), GRACE, atol=1e-12)
    assert_lit(page, egg, GRACE)
    page.page.uncheck("#painted")
    assert_lit(page, egg, GRACE, painted=False)


def test_light_and_object_turned_by_keys(show, egg):
    page = show(viewer(egg, GRACE).html)
    page.press("Shift+ArrowRight", 6)
    page.press("Shift+ArrowUp", 3)
    page.press("ArrowLeft", 4)
    page.press("ArrowDown", 5)
    # The last turn is the outermost.
    turn = turned_by("yx", -4 * STEP, 5 * STEP)
    light = rotate(GRACE, turned_by("yx", 6 * STEP, -3 * STEP))
    np.testing.assert_allclose(page.state()["object_rotation"], turn, atol=1e-12)
    np.testing.assert_allclose(nine(page), light, atol=1e-12)
    assert_lit(page, egg, light, turn)


@pytest.mark.parametrize("turns_light", [False, True])
def test_a_drag_turns(show, egg, turns_light):
    page = show(viewer(egg, GRACE).html)
    size = min(page.page.evaluate("[view.clientWidth, view.clientHeight]"))
    if turns_light:
        page.page.keyboard.down("Shift")
    page.page.mouse.move(150, 150)
    page.page.mouse.down()
    page.page.mouse.move(190, 130)
    page.page.mouse.up()
    turn = turned_by("yx", 360 * 40 / size, -360 * 20 / size)
    if turns_light:
        assert_lit(page, egg, rotate(GRACE, turn))
    else:
        assert_lit(page, egg, GRACE, turn)


@pytest.mark.parametrize("channel", ["all", "2"])
def test_a_slider_dragged(show, egg, channel):
    page = show(viewer(egg, GRACE).html)
    page.press("Shift+ArrowRight", 2)
    before = nine(page)
    page.choose("channel", channel)
    slider = page.page.locator("#slider6")
    slider.scroll_into_view_if_needed()
    box = slider.bounding_box()
    middle = box["y"] + box["height"] / 2
    page.page.mouse.move(box["x"] + box["width"] / 2, middle)
    page.page.mouse.down()
    page.page.mouse.move(box["x"] + 0.8 * box["width"], middle, steps=5)
    page.page.mouse.up()
    after = nine(page)
    moved = np.zeros(before.shape, bool)
    moved[slice(None) if channel == "all" else int(channel), 6] = True
    np.testing.assert_allclose(after[~moved], before[~moved], atol=1e-12)
    change = (after - before)[moved]
    np.testing.assert_allclose(change, change[0], atol=1e-12)
    assert change[0] > 0.2
    assert_lit(page, egg, after)


def test_the_wheel_zooms(show, egg):
    page = show(viewer(egg, GRACE).html)
    before = page.picture()
    page.page.mouse.move(150, 150)
    page.page.mouse.wheel(0, -300)
    page.page.wait_for_timeout(100)
    ground = before[5, 5]
    closer = page.picture()
    assert (closer != ground).any(axis=-1).sum() > 1.2 * (before != ground).any(axis=-1).sum()
    page.press("Home")
    np.testing.assert_array_equal(page.picture(), before)


def test_normals_albedo_and_colours_of_vertices(show, egg):
    colours = np.clip(0.5 + 0.4 * egg.vertices, 0, 1)
    page = show(viewer(egg, GRACE, colours={"confidence": colours}).html)
    page.choose("ways", "normals")
    shown = page.picture()
    seen = views(egg, shown.shape[:2])
    assert_shown(shown, seen, lambda view: (view.normals + 1) / 2)
    page.choose("ways", "albedo")
    assert_shown(page.picture(), seen, lambda view: linear_to_srgb(view.albedo))
    page.choose("ways", "confidence")
    seen = views(replace(egg, albedo=np.round(255 * colours) / 255), shown.shape[:2])
    assert_shown(page.picture(), seen, lambda view: view.albedo)


def assert_carried(page, mesh, values, encode, turn=None):
    """Check that a page shows values between the vertices, encoded at the exposure it tells."""
    shown, exposure = page.picture(), page.state()["exposure"]
    # The camera interpolates albedo just so.
    scale = np.abs(values).max()
    carrier = replace(mesh, albedo=(values / scale + 1) / 2)
    assert_shown(
        shown,
        views(carrier, shown.shape[:2], turn),
        lambda view: encode(scale * (2 * view.albedo - 1), exposure),
    )


def test_transfer_vectors_turn_with_light_and_object(show, egg):
    rng = np.random.default_rng(0)
    light = rng.normal(size=(3, 25))
    light[:, 0] = 6
    # Any functions of the surface serve; those of a convex one could be had from its normals.
    transfer = 2 + rng.normal(size=(3, 25, 3)) @ egg.normals.T
    page = show(viewer(egg, light, transfer=transfer).html)
    page.page.uncheck("#painted")
    page.press("Shift+ArrowRight", 6)
    page.press("ArrowDown", 5)
    page.page.click("#fit")
    turn = turned_by("x", 5 * STEP)
    local = rotate(light, turn.T @ turned_by("y", 6 * STEP))
    assert_carried(page, egg, np.einsum("ck,ckv->vc", local, transfer), in_picture, turn)


def test_transfer_of_a_convex_object_is_what_its_normals_tell(show, egg):
    transfer = harmonic_irradiance(np.eye(9), egg.normals)
    page = show(viewer(egg, GRACE, transfer=transfer).html)
    page.page.uncheck("#painted")
    assert_carried(page, egg, harmonic_irradiance(GRACE, egg.normals).T, in_picture)


def test_difference_from_a_reference(show, egg):
    excess = np.array([0.3, 0.6, -0.1])[:, None] * egg.normals[:, 0]
    reference = harmonic_irradiance(GRACE, egg.normals) - excess
    page = show(viewer(egg, GRACE, reference=reference).html)
    page.page.uncheck("#painted")
    page.press("Shift+ArrowRight", 3)
    # The reference holds for one light and the object at rest: both go there, and turn together.
    page.choose("sources", "reference")
    np.testing.assert_allclose(nine(page), GRACE, atol=1e-12)
    page.press("ArrowRight", 3)
    turn = turned_by("y", 3 * STEP)
    np.testing.assert_allclose(nine(page), rotate(GRACE, turn), atol=1e-12)
    assert_carried(page, egg, reference.T, in_picture, turn)
    page.choose("ways", "difference")
    page.press("ArrowRight", 3)
    shown, exposure = page.picture(), page.state()["exposure"]
    scale = np.abs(reference).max()
    carrier = replace(egg, albedo=(reference.T / scale + 1) / 2)

    def difference(view):
        found = radiosity(view, rotate(GRACE, turn), painted=False)
        return in_signed_colours(found - scale * (2 * view.albedo - 1), exposure)

    assert_shown(shown, views(carrier, shown.shape[:2], turn), difference)


def test_the_map_behind_and_on_the_mirror_sphere(show, egg):
    directions = layout_named("latlong").directions(64)
    smooth = np.stack([1 + 0.5 * directions[..., axis] for axis in range(3)], axis=-1)
    light = EnvironmentMap.from_image(smooth, "latlong")
    page = show(viewer(egg, light).html)
    page.press("Shift+ArrowRight", 6)
    shown, state = page.picture(), page.state()
    turned = light.rotated(Rotation.from_euler("y", 6 * STEP, degrees=True).as_matrix())
    height, width = shown.shape[:2]
    x = (np.arange(width) + 0.5) / width * 2 - 1
    y = 1 - (np.arange(height) + 0.5) / height * 2
    across, up = np.meshgrid(x * width / height, y)
    rays = np.stack([across, up, -np.ones_like(up)], axis=-1)
    rays /= np.linalg.norm(rays, axis=-1, keepdims=True)

    def seen_towards(directions):
        radiance = np.moveaxis(sample(turned, directions), 0, -1)
        return in_picture(np.pi * radiance, state["exposure"])

    behind = seen_towards(rays)
    side, margin = round(0.22 * min(height, width)), round(0.02 * min(height, width))
    free = ~binary_dilation(views(egg, (height, width))[0].mask, iterations=2)
    free[height - 2 * margin - side :, : 2 * margin + side] = False
    assert free.mean() > 0.2
    # Nine bits a channel in the page's map, and eight of a place between its pixels.
    assert np.abs(shown - behind)[free].max() <= 2 * CODE
    place = (np.arange(side) + 0.5) / side * 2 - 1
    u, v = np.meshgrid(place, -place)
    inside = u**2 + v**2 < 0.9
    n = np.stack([u, v, np.sqrt(np.maximum(1 - u**2 - v**2, 0))], axis=-1)
    mirrored = 2 * n[..., 2:] * n - [0, 0, 1]
    corner = shown[height - margin - side : height - margin, margin : margin + side]
    assert np.abs(corner[inside] - seen_towards(mirrored[inside])).max() <= 2 * CODE


def test_names_are_text_whatever_they_are(show, egg):
    name = "</script><script>alert(1)</script><img src=x onerror=alert(2)> \u2028 &amp; '\""
    named = viewer(
        egg,
        GRACE,
        title=name,
        light_name=name,
        presets={name: GRACE},
        colours={name: np.ones((len(egg.vertices), 3))},
    )
    page = show(named.html)
    page.settle()
    assert page.page.inner_text("h1") == name
    assert page.page.title() == name
    assert page.page.locator("#lights option").all_inner_texts().count(name) == 2
    assert name in page.page.locator("#ways option").all_inner_texts()


def test_the_copied_light_is_the_light(show, egg, tmp_path):
    page = show(viewer(egg, GRACE).html)
    page.press("Shift+ArrowRight", 6)
    light = rotate(GRACE, Rotation.from_euler("y", 6 * STEP, degrees=True).as_matrix())
    (tmp_path / "light.json").write_text(page.copied("Json"))
    read = read_coefficients(tmp_path / "light.json")
    np.testing.assert_allclose(read[:, :9], light, atol=1e-12)
    matrices = re.findall(r"mat4\((.*?)\)", page.copied("Glsl"))
    numbers = np.array([[float(word) for word in text.split(",")] for text in matrices])
    np.testing.assert_allclose(
        numbers.reshape(3, 4, 4), irradiance_matrix(light), rtol=1e-8, atol=1e-12
    )


def test_a_notebook_shows_it_in_a_frame(show, egg):
    page = show(viewer(egg, GRACE, title="in a frame")._repr_html_())
    inside = page.page.frame_locator("iframe")
    assert inside.locator("h1").inner_text() == "in a frame"
    assert inside.locator("#failure").is_hidden()
    assert inside.locator("#value0").inner_text() == f"{GRACE[:, 0].mean():.3f}"


def test_a_flat_picture_turns_its_light_only(show):
    rows = 24
    y, x = np.mgrid[:rows, :rows]
    mesh = depth_to_mesh(np.zeros((rows, rows)), np.ones((rows, rows), bool))
    images = 1 + 0.1 * np.random.default_rng(0).normal(size=(9, 1, 1)) * (x + y) / rows
    page = show(viewer(mesh, GRACE, transfer=images.reshape(9, -1), flat=True).html)
    page.press("ArrowRight", 6)
    light = rotate(GRACE, turned_by("y", 6 * STEP))
    assert page.state()["object_rotation"] == np.eye(3).tolist()
    assert_carried(page, mesh, (light @ images.reshape(9, -1)).T, in_picture)


def fingers(page):
    """Return a function that sends what a touch screen does, with any number of fingers."""
    session = page.page.context.new_cdp_session(page.page)

    def send(kind, *places):
        points = [{"x": x, "y": y, "id": number} for number, (x, y) in enumerate(places)]
        session.send("Input.dispatchTouchEvent", {"type": kind, "touchPoints": points})

    return send


def test_one_finger_turns_the_object(show, egg):
    page = show(viewer(egg, GRACE).html)
    size = min(page.page.evaluate("[view.clientWidth, view.clientHeight]"))
    touch = fingers(page)
    touch("touchStart", (150, 150))
    touch("touchMove", (190, 130))
    touch("touchEnd")
    turn = turned_by("yx", 360 * 40 / size, -360 * 20 / size)
    np.testing.assert_allclose(page.state()["object_rotation"], turn, atol=1e-12)
    np.testing.assert_allclose(nine(page), GRACE, atol=1e-12)


def test_two_fingers_turn_the_light_and_apart_they_zoom(show, egg):
    page = show(viewer(egg, GRACE).html)
    size = min(page.page.evaluate("[view.clientWidth, view.clientHeight]"))
    before = page.picture()
    touch = fingers(page)
    touch("touchStart", (150, 150), (250, 150))
    touch("touchMove", (190, 150), (290, 150))
    touch("touchEnd")
    assert page.state()["object_rotation"] == np.eye(3).tolist()
    turned = rotate(GRACE, turned_by("y", 360 * 40 / size))
    np.testing.assert_allclose(nine(page), turned, atol=1e-12)
    ground = before[5, 5]
    touch("touchStart", (150, 150), (250, 150))
    touch("touchMove", (130, 150), (270, 150))
    touch("touchEnd")
    closer = page.picture()
    assert (closer != ground).any(axis=-1).sum() > 1.2 * (before != ground).any(axis=-1).sum()
