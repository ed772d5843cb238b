import numpy as np
import pytest
from scipy.integrate import quad
from scipy.special import eval_legendre

from data_synth.faces import head
from data_synth.lightings import yale64
from data_synth.shapes import sphere
from harmface.errors import ArgumentError
from harmface.geometry import frame_orthographic, gbuffer
from harmface.light import DistantLight
from harmface.recognition import (
    enroll,
    extended_bases,
    orthonormal_basis,
    phong_coefficients,
    specular_images,
    subject_highlights,
    subspace_distances,
)
from harmface.reflectance import Phong
from harmface.rendering import render
from harmface.reproduce.synthetic import light_of, mesh_of
from harmface.sphere import fibonacci_directions, random_directions, real_harmonics

EXPONENT, SIZE = 8.0, 32


@pytest.mark.parametrize("exponent", [0.0, 1.0, 7.5, 40.0])
def test_coefficients_are_the_integrals(exponent):
    found = phong_coefficients(exponent, 9)
    for degree, value in enumerate(found):
        integral = quad(lambda c, n=degree: c**exponent * eval_legendre(n, c), 0, 1)[0]
        assert value == pytest.approx(2 * np.pi * integral, abs=1e-10)


def test_images_are_those_of_the_lobe_by_brute_force(rng):
    normals = random_directions(30, rng)
    normals[:, 2] = np.abs(normals[:, 2])
    towards = np.broadcast_to([0.0, 0.0, 1.0], normals.shape)
    light = np.append(3.0, rng.standard_normal(24))
    directions = fibonacci_directions(20_000)
    mirrored = 2 * normals[:, 2:] * normals - towards
    lobe = np.maximum(mirrored @ directions.T, 0) ** EXPONENT
    total = lobe @ (light @ real_harmonics(directions, 4)) * 4 * np.pi / 20_000
    expected = (EXPONENT + 2) / 2 * normals[:, 2] * total
    found = light @ specular_images(normals, towards, EXPONENT, 4)
    # Twenty thousand directions integrate a function of degree 12 to single precision or so.
    assert np.allclose(found, expected, atol=1e-4 * np.abs(expected).max())


def test_with_the_share_known_the_oracles_highlights_are_nearly_met(rng):
    view = gbuffer(mesh_of(sphere()), frame_orthographic(mesh_of(sphere()), 24))
    directions = fibonacci_directions(4000)
    light = np.array([1.0, 0.3, -0.2, 0.2, 0.05, 0.04, 0.1, -0.06, 0.1])
    radiance = light @ real_harmonics(directions, 2)
    assert radiance.min() > 0
    sampled = DistantLight(directions, 4 * np.pi / 4000 * radiance)
    white = np.ones(view.mask.shape)
    shiny = render(view, sampled, albedo=white, material=Phong(40))
    inner = view.normals[..., 2] > 0.6
    normals = view.normals[inner]
    towards = np.broadcast_to([0.0, 0.0, 1.0], normals.shape)
    found = light @ specular_images(normals, towards, 40, 2)
    expected = shiny[inner]
    # The cosine of incidence varies by a few per cent over a lobe 13 degrees wide.
    assert np.abs(found - expected).max() < 0.05 * expected.max()


def test_no_other_dimension_holds_more_of_the_highlights(rng):
    bases = orthonormal_basis(rng.standard_normal((2, 9, 60)), 9)
    specular = rng.standard_normal((2, 16, 60)) * np.linspace(2, 0.1, 16)[:, None]
    extended = extended_bases(bases, specular, 2)
    assert np.allclose(extended @ extended.swapaxes(1, 2), np.eye(11))

    def left(own, rows):
        rest = specular[own] - specular[own] @ rows.T @ rows
        return (rest**2).sum()

    for own in range(2):
        best = left(own, extended[own])
        for _ in range(50):
            other = rng.standard_normal((2, 16)) @ specular[own]
            rows = orthonormal_basis(np.concatenate([bases[own], other]), 11)
            assert left(own, rows) >= best - 1e-9


def test_shiny_probes_lie_nearer_and_are_recognised_more_often():
    meshes = {
        str(seed): mesh_of(head(seed, n_vertices=5000, identity_scale=0.7)) for seed in range(6)
    }
    gallery = enroll(meshes, SIZE, cast_shadows=False)
    lights, probes = light_of(yale64()), []
    for mesh in meshes.values():
        view = gbuffer(mesh, frame_orthographic(mesh, SIZE), 2)
        white, coat = np.ones(view.mask.shape), Phong(EXPONENT, 0.15)
        shiny = render(view, lights, caster=mesh)
        shiny += render(view, lights, albedo=white, caster=mesh, material=coat)
        probes.append(shiny[:, gallery.mask])
    highlights = [subject_highlights(mesh, SIZE, EXPONENT) for mesh in meshes.values()]
    bases = orthonormal_basis(gallery.harmonic[..., gallery.mask], 9)
    truth = np.repeat(range(6), 64)
    errors, own = [], []
    for each in (bases, extended_bases(bases, np.stack(highlights)[..., gallery.mask], 2)):
        distances = subspace_distances(np.concatenate(probes), each)
        errors.append((distances.argmin(axis=1) != truth).sum())
        own.append((distances[np.arange(len(truth)), truth] ** 2).mean())
    assert own[1] < 0.9 * own[0]
    assert errors[1] < 0.9 * errors[0]


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (lambda: phong_coefficients(-1.0, 2), "exponent must lie in"),
        (lambda: phong_coefficients(1.0, -2), "max_degree must be 0 or more"),
        (lambda: specular_images(np.ones((2, 3)), np.ones((2, 3)), 1.0), "unit vectors"),
        (lambda: specular_images(np.eye(3), np.eye(3)[:2], 1.0), "must match normals"),
        (lambda: extended_bases(np.ones((1, 2, 5)), np.ones((1, 3, 5)), 4), "at least 4 images"),
        (lambda: extended_bases(np.ones((1, 2, 5)), np.ones((1, 3, 4))), "pixels of bases"),
        (lambda: extended_bases(np.ones((1, 2, 5)), np.ones((1, 3, 5)), 0), "extra must be 1"),
    ],
)
@pytest.mark.usefixtures("unchecked")
def test_nonsense_is_refused(call, message):
    with pytest.raises(ArgumentError, match=message):
        call()
