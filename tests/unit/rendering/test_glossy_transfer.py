import numpy as np
import pytest

from data_synth.shapes import ellipsoid, half_sphere
from harmface.conventions import degrees
from harmface.errors import ArgumentError
from harmface.geometry import visible
from harmface.rendering import clustered_pca, glossy_radiance, glossy_transfer
from harmface.reproduce.synthetic import mesh_of
from harmface.sphere import gauss_legendre, synthesize

LOBE = np.array([1.0, 0.9, 0.7, 0.5, 0.3])
LIGHT = np.random.default_rng(3).standard_normal((2, 25)) / (1 + degrees(4))


def bowl():
    return mesh_of(half_sphere(16)).flipped()


@pytest.mark.parametrize("shape", ["convex", "bowl"])
def test_what_is_shown_is_the_integral_of_open_light_and_lobe(shape, rng):
    mesh = mesh_of(ellipsoid(16)) if shape == "convex" else bowl()
    some = rng.choice(len(mesh.vertices), 12, replace=False)
    to_camera = mesh.normals[some] + 0.7 * rng.standard_normal((12, 3))
    to_camera /= np.linalg.norm(to_camera, axis=1, keepdims=True)
    normals = mesh.normals[some]
    matrices = glossy_transfer(mesh, LOBE, samples=16384)[some]
    shown = np.einsum("vij,cj->vci", matrices, LIGHT)
    found = glossy_radiance(shown, normals, to_camera)
    rule = gauss_legendre(120)
    open_sky = visible(mesh, mesh.vertices[some], normals, rule.directions)
    radiance = synthesize(LIGHT, rule.directions) * rule.weights
    along = (normals * to_camera).sum(axis=1)
    mirrored = 2 * along[:, None] * normals - to_camera
    # The lobe as a function of the angle, by Legendre polynomials.
    cosines = np.clip(rule.directions @ mirrored.T, -1, 1)
    series = LOBE * (2 * np.arange(5) + 1) / (4 * np.pi)
    lobe = np.polynomial.legendre.legval(cosines, series)
    expected = np.einsum("cj,jv,jv->vc", radiance, lobe, open_sky) * (along > 0)[:, None]
    # The rule's own error at the edge of what is open is a part in a hundred.
    assert np.abs(found - expected).max() < 0.02 * np.abs(expected).max()


def test_compression_loses_less_with_more_components_and_rounds():
    matrices = glossy_transfer(bowl(), LOBE[:3], samples=512)

    def error(clusters, components, rounds=20):
        made = clustered_pca(matrices, clusters, components, rounds=rounds)
        return np.sum((made.matrices() - matrices) ** 2)

    by_components = [error(4, n) for n in (0, 1, 2, 4, 8)]
    assert (np.diff(by_components) < 0).all()
    by_rounds = [error(4, 2, rounds) for rounds in (1, 2, 4, 16)]
    assert (np.diff(by_rounds) < 0).all()
    assert error(8, 2) < error(4, 2) < error(1, 2)
    assert error(1, 81) < 1e-20 * np.sum(matrices**2)


def test_light_is_applied_to_the_components():
    matrices = glossy_transfer(bowl(), LOBE[:3], samples=512)
    made = clustered_pca(matrices, 4, 3)
    light = LIGHT[:, :9]
    np.testing.assert_allclose(
        made.apply(light), np.einsum("vij,cj->vci", made.matrices(), light), atol=1e-12
    )


def test_nonsense_is_refused(unchecked):
    matrices, up = np.random.default_rng(0).random((5, 4, 4)), np.array([[0.0, 0.0, 1.0]])
    for match, call in {
        "lobe must have a factor": lambda: glossy_transfer(bowl(), np.ones((2, 2))),
        "at most 5 and 16": lambda: clustered_pca(matrices, 6, 1),
        "at most 5 and 16, as": lambda: clustered_pca(matrices, 2, 17),
        "components must be 0": lambda: clustered_pca(matrices, 2, -1),
        "rounds must be 1": lambda: clustered_pca(matrices, 2, 1, rounds=0),
        "to_camera must be unit": lambda: glossy_radiance(np.ones((1, 4)), up, 2 * up),
    }.items():
        with pytest.raises(ArgumentError, match=match):
            call()
