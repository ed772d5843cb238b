import numpy as np
import pytest

from data_synth.shapes import ellipsoid, sphere
from harmface.errors import ArgumentError
from harmface.geometry import Mesh, frame_orthographic, gbuffer
from harmface.light import DistantLight
from harmface.recognition import enroll, subject_photographs
from harmface.rendering import harmonic_images, relight, render, shadowed_harmonic_images
from harmface.reproduce.synthetic import mesh_of
from harmface.sphere import real_harmonics


def seen(mesh, size=12):
    return gbuffer(mesh, frame_orthographic(mesh, size))


def test_a_convex_object_has_the_harmonic_images_of_lambert():
    mesh = mesh_of(ellipsoid())
    view = seen(mesh)
    albedo = view.albedo @ np.array([0.2126, 0.7152, 0.0722])
    expected = harmonic_images(view.normals, albedo)
    # 770 directions sample the edge of a hemisphere, where the cosine has a kink, to about a
    # part in a thousand; near its outline the mesh shadows itself where the facets end.
    inner = view.normals[..., 2] > 0.3
    found = shadowed_harmonic_images(view, mesh)
    assert np.abs(found - expected)[:, inner].max() < 5e-3 * expected.max()


def two_spheres():
    """A small sphere in front of and above a large one, onto which it casts a shadow."""
    large, small = mesh_of(sphere()), mesh_of(sphere())
    moved = 0.4 * small.vertices + np.array([0, 1.2, 1.0])
    return Mesh(
        np.concatenate([large.vertices, moved]),
        np.concatenate([large.faces, small.faces + len(large.vertices)]),
        np.concatenate([large.normals, small.normals]),
        np.concatenate([large.albedo, small.albedo]),
    )


def test_a_smooth_light_casts_the_shadows_of_the_oracle(rng):
    mesh = two_spheres()
    view = seen(mesh)
    directions = rng.standard_normal((4000, 3))
    directions /= np.linalg.norm(directions, axis=1, keepdims=True)
    light = np.array([1.0, 0.3, -0.2, 0.2, 0.05, 0.04, 0.1, -0.06, 0.1])
    radiance = light @ real_harmonics(directions, 2)
    assert radiance.min() > 0
    sampled = DistantLight(directions, 4 * np.pi / 4000 * radiance)
    oracle = render(view, sampled, caster=mesh)
    found = relight(light, shadowed_harmonic_images(view, mesh))
    unshadowed = render(view, sampled)
    # A sum over 4,000 random directions is right to 1.5 %, twice over three deviations.
    tolerance = 0.06 * oracle.max()
    assert np.abs(found - oracle).max() < tolerance
    assert np.abs(unshadowed - oracle).max() > 2 * tolerance


def test_directions_are_taken_a_few_at_a_time_without_effect(monkeypatch):
    mesh = two_spheres()
    view = seen(mesh, 6)
    whole = shadowed_harmonic_images(view, mesh, 1)
    monkeypatch.setattr("harmface.rendering.precomputed_transfer.PAIRS", 5000)
    assert np.allclose(whole, shadowed_harmonic_images(view, mesh, 1))


def test_a_gallery_with_cast_shadows_is_darker_where_they_fall():
    meshes = {"pair": two_spheres()}
    gallery = enroll(meshes, 12)
    plain, shadowed = gallery.harmonic[0, 0], gallery.shadowed[0, 0]
    assert shadowed.min() >= 0
    assert (shadowed < 0.8 * plain).sum() >= 5


def test_a_convex_gallery_is_the_same_with_and_without():
    meshes = {"ball": mesh_of(sphere())}
    gallery = enroll(meshes, 16)
    plain, shadowed = gallery.harmonic, gallery.shadowed[:, :9]
    inner = plain[0, 2] > 0.5 * plain[0, 2].max()
    # The mean over a pixel of images, and the image of its mean normal, differ by its curvature.
    assert np.abs(plain - shadowed)[0][:, inner].max() < 0.02 * plain.max()


def test_photographs_are_those_of_the_oracle_averaged_over_pixels():
    mesh = two_spheres()
    light = DistantLight(np.array([[0.0, 0.6, 0.8]]), np.ones((1, 1)))
    photographs = subject_photographs(mesh, light, 8)
    fine = render(seen(mesh, 16), light, caster=mesh)
    assert np.allclose(photographs[0, 3, 4], fine[0, 6:8, 8:10].mean())


def test_a_degree_below_zero_is_refused():
    mesh = mesh_of(sphere())
    with pytest.raises(ArgumentError, match="degree must be 0 or more"):
        shadowed_harmonic_images(seen(mesh), mesh, -1)
