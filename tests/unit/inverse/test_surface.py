import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from data_synth.environments import ENVIRONMENTS
from data_synth.faces import head
from data_synth.shapes import ellipsoid
from harmface.conventions import luminance
from harmface.errors import ArgumentError
from harmface.geometry import frame_orthographic, gbuffer
from harmface.inverse import (
    PhotographedSurface,
    camera_from_mask,
    estimate_light,
    estimate_light_and_albedo,
    pose_from_landmarks,
    relight_photograph,
)
from harmface.light import DistantLight
from harmface.rendering import irradiance, render
from harmface.reproduce.irradiance import SUNNY
from harmface.reproduce.synthetic import mesh_of
from harmface.sphere import fibonacci_directions, real_harmonics

DIRECTIONS = fibonacci_directions(300)


def surroundings(name="nave"):
    radiance = ENVIRONMENTS[name]().radiance(DIRECTIONS)
    return DistantLight(DIRECTIONS, luminance(radiance) * 4 * np.pi / len(DIRECTIONS))


@pytest.fixture(scope="module")
def face():
    mesh = mesh_of(head(3, n_vertices=8000))
    return mesh, PhotographedSurface.of_mesh(mesh, (64, 64))


def facing_error(found, light, scaled):
    facing = fibonacci_directions(600)
    facing = facing[facing[:, 2] > 0]
    truth, got = irradiance(facing, light), found.irradiance(facing)
    if scaled:
        got = got * (got @ truth) / (got @ got)
    return np.abs(got - truth).mean() / truth.mean()


def test_light_of_a_head_with_cast_shadows(face, rng):
    mesh, surface = face
    basis = surface.harmonic_irradiances(2)
    given = {"mask": surface.inner, "visibility": basis}
    errors = []
    for name in ENVIRONMENTS:
        if name in SUNNY:
            continue
        light = surroundings(name)
        image = render(surface.view, light, caster=mesh)
        image = image + 0.01 * image[surface.mask].mean() * rng.standard_normal(image.shape)
        known = estimate_light(image, surface.normals, luminance(surface.albedo), **given)
        unknown, albedo = estimate_light_and_albedo(image, surface.normals, **given)
        constant = estimate_light(image, surface.normals, **given)
        assert np.median(albedo[surface.inner & (albedo > 0)]) == pytest.approx(1)
        errors.append(
            [
                facing_error(known, light, scaled=False),
                facing_error(unknown, light, scaled=True),
                facing_error(constant, light, scaled=True),
            ]
        )
    known, unknown, constant = np.median(errors, axis=0)
    assert known < 0.03
    assert unknown < 0.10
    assert unknown < constant


def test_relit_photographs_look_as_rendered(face):
    mesh, surface = face
    old, new = surroundings("nave"), surroundings("clear_sky")
    photo, wanted = (render(surface.view, light, caster=mesh) for light in (old, new))
    relit = relight_photograph(
        photo, surface.irradiance(old), surface.irradiance(new), surface.mask, exposure=1.0
    )
    lit = surface.mask & (surface.irradiance(old) > 0.2 * surface.irradiance(old).max())
    assert np.allclose(relit[lit], wanted[lit], rtol=1e-9)
    assert np.array_equal(relit[~surface.mask], photo[~surface.mask])
    kept = relight_photograph(photo, surface.irradiance(old), surface.irradiance(new), surface.mask)
    assert kept[surface.mask].mean() == pytest.approx(photo[surface.mask].mean())


def test_surfaces_of_normals_have_no_cast_shadows(face):
    _, surface = face
    bare = PhotographedSurface.of_normals(surface.normals)
    light = surroundings()
    expected = irradiance(surface.normals[surface.mask], light)
    assert np.allclose(bare.irradiance(light)[surface.mask], expected)
    assert (surface.irradiance(light)[surface.mask] <= expected + 1e-9).all()
    coefficients = light.irradiances @ real_harmonics(DIRECTIONS, 4).T
    harmonic = bare.irradiance(coefficients)[surface.mask]
    assert np.abs(harmonic - expected).mean() < 0.02 * expected.mean()


def test_within_a_mask(face):
    _, surface = face
    left = np.zeros(surface.mask.shape, bool)
    left[:, :32] = True
    assert not surface.within(left).inner[:, 32:].any()
    with pytest.raises(ArgumentError, match="meet the surface"):
        surface.within(np.zeros_like(left))


def seen_at(mesh, camera, points):
    scale = camera.height / camera.shape[0]
    column = (points[:, 0] - camera.center[0]) / scale + camera.shape[1] / 2
    row = camera.shape[0] / 2 - (points[:, 1] - camera.center[1]) / scale
    return np.column_stack([column, row])


def test_landmarks_place_and_turn_a_mesh(face):
    mesh, _ = face
    turned = mesh.rotated(Rotation.from_euler("yx", [20, -10], degrees=True).as_matrix())
    camera = frame_orthographic(turned, (80, 60))
    some = [5, 1000, 2500, 4000, 6000, 7000]
    pixels = seen_at(turned, camera, turned.vertices[some])
    placed, found = pose_from_landmarks(mesh, pixels, mesh.vertices[some], (80, 60))
    assert np.allclose(placed.normals, turned.normals, atol=1e-6)
    assert np.allclose(
        seen_at(placed, found, placed.vertices), seen_at(turned, camera, turned.vertices), atol=1e-6
    )


def test_two_landmarks_turn_a_mesh_in_the_picture_alone(face):
    mesh, _ = face
    turned = mesh.rotated(Rotation.from_euler("z", 15, degrees=True).as_matrix())
    camera = frame_orthographic(turned, (50, 50))
    some = [5, 6000]
    pixels = seen_at(turned, camera, turned.vertices[some])
    placed, found = pose_from_landmarks(mesh, pixels, mesh.vertices[some], (50, 50))
    assert np.allclose(placed.vertices[:, :2], turned.vertices[:, :2], atol=1e-6)
    assert found.height == pytest.approx(camera.height)


def test_outlines_place_a_mesh():
    mesh = mesh_of(ellipsoid())
    large = gbuffer(mesh, frame_orthographic(mesh, 60)).mask
    mask = np.zeros((100, 120), bool)
    mask[20:80, 45:105] = large
    camera = camera_from_mask(mesh, mask)
    assert (gbuffer(mesh, camera).mask != mask).mean() < 0.01


@pytest.mark.parametrize(
    ("pixels", "points", "message"),
    [
        (np.ones((1, 2)), np.ones((1, 3)), "at least 2 pairs"),
        (np.ones((3, 2)), np.ones((2, 3)), "pairs"),
        (np.ones((3, 2)), np.ones((3, 3)), "different places"),
    ],
)
@pytest.mark.usefixtures("unchecked")
def test_landmarks_that_place_nothing_are_refused(face, pixels, points, message):
    with pytest.raises(ArgumentError, match=message):
        pose_from_landmarks(face[0], pixels, points, (10, 10))


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"mask": np.zeros((4, 4), bool)}, "show the surface"),
        ({"before": np.zeros((4, 4))}, "before must not leave"),
        ({"after": np.zeros((3, 3))}, "must be of"),
        ({"after": np.ones((3, 4, 4))}, "photo must have channels"),
        ({"floor": -1.0}, "negative"),
    ],
)
@pytest.mark.usefixtures("unchecked")
def test_relighting_nonsense_is_refused(changes, message):
    ones = np.ones((4, 4))
    given = {"photo": ones, "before": ones, "after": ones, "mask": ones > 0, **changes}
    with pytest.raises(ArgumentError, match=message):
        relight_photograph(**given)


def test_an_empty_mask_places_nothing():
    with pytest.raises(ArgumentError, match="false everywhere"):
        camera_from_mask(mesh_of(ellipsoid()), np.zeros((8, 8), bool))


def test_a_grey_light_relights_colour():
    photo = np.full((4, 4, 3), [0.2, 0.3, 0.4])
    ones = np.ones((4, 4))
    relit = relight_photograph(photo, ones, 2 * ones, ones > 0, exposure=1.0)
    assert np.allclose(relit, 2 * photo)
