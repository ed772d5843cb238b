import numpy as np
import pytest

from harmface.pca import gram, harmonic_gram
from harmface.pca.gram import chunks
from harmface.sphere import gauss_legendre, random_directions, real_harmonics


def test_products_are_summed_over_weighted_normals(rng):
    normals, weights = random_directions(300, rng), rng.uniform(0, 2, 300)
    basis = real_harmonics(normals, 3)
    expected = (basis * weights) @ basis.T
    np.testing.assert_allclose(harmonic_gram(normals, weights, 3), expected, rtol=1e-12, atol=1e-11)


@pytest.mark.parametrize("size", [1, 99, 100, 101, 300])
def test_the_chunks_do_not_matter(rng, size, monkeypatch):
    normals, weights = random_directions(300, rng), rng.uniform(0, 2, 300)
    whole = harmonic_gram(normals, weights, 2)
    monkeypatch.setattr(gram, "CHUNK", size)
    np.testing.assert_allclose(harmonic_gram(normals, weights, 2), whole, rtol=1e-12, atol=1e-12)


def test_over_the_sphere_harmonics_are_orthonormal():
    rule = gauss_legendre(6)
    found = harmonic_gram(rule.directions, rule.weights, 3)
    np.testing.assert_allclose(found, np.eye(16), atol=1e-13)


def test_only_products_of_those_kept_are_there(rng):
    normals, weights = random_directions(50, rng), np.ones(50)
    kept = np.array([0, 3, 8])
    found = harmonic_gram(normals, weights, 2, kept)
    whole = harmonic_gram(normals, weights, 2)
    np.testing.assert_allclose(found[np.ix_(kept, kept)], whole[np.ix_(kept, kept)], rtol=1e-12)
    found[np.ix_(kept, kept)] = 0
    assert not found.any()


def test_chunks_cover_all_in_order():
    assert [range(10)[some] for some in chunks(10, 4)] == [range(4), range(4, 8), range(8, 10)]
    assert list(chunks(8, 4)) == [slice(0, 4), slice(4, 8)]
    assert list(chunks(0, 4)) == []
