"""From a Gram matrix to components: signs and what is refused."""

import numpy as np
import pytest

from harmface.errors import ArgumentError
from harmface.pca import (
    cone_gram,
    cylinder_gram,
    environment_lights,
    front_lights,
    isotropic_lights,
    lighting_pca,
    sphere_gram,
    uniform_lights,
)


def test_modes_of_a_frontal_sphere_are_bright_ahead_on_the_right_and_above():
    pca = lighting_pca(sphere_gram(4, "pixels"))
    assert pca.max_degree == 4
    largest = np.abs(pca.expansion).argmax(axis=1)
    assert set(largest[:3]) == {1, 2, 3}
    assert (pca.expansion[np.arange(len(largest)), largest] > 0).all()


def test_power_of_a_degree_scales_its_modes():
    pca = lighting_pca(np.eye(9), isotropic_lights(np.array([0.0, 1.0, 0.0])))
    assert len(pca.expansion) == 3
    assert np.allclose(pca.eigenvalues[:3], (2 * np.pi / 3) ** 2, rtol=1e-14)
    assert not pca.eigenvalues[3:].any()


def test_light_of_another_degree():
    with pytest.raises(ArgumentError, match="degree 3 as the Gram matrix has, got degree 2"):
        lighting_pca(np.eye(16), uniform_lights(2))


def test_light_that_does_not_vary():
    once = environment_lights(np.ones((1, 9)))
    with pytest.raises(ArgumentError, match="none varies"):
        lighting_pca(np.eye(9), once)
    kept = lighting_pca(np.eye(9), once, subtract_mean=False)
    assert np.abs(kept.fractions - np.eye(9)[0]).max() < 1e-15


def test_gram_must_be_finite_and_of_all_harmonics():
    with pytest.raises(ArgumentError, match="gram must be finite"):
        lighting_pca(np.full((4, 4), np.nan))
    with pytest.raises(ArgumentError, match="must be a square"):
        lighting_pca(np.eye(5))


@pytest.mark.parametrize("shape", [sphere_gram, cylinder_gram])
@pytest.mark.usefixtures("unchecked")
def test_unknown_measure(shape):
    with pytest.raises(ArgumentError, match="measure must be one of"):
        shape(2, "faces")


@pytest.mark.parametrize("elevation", [90.0, -90.0, np.nan])
def test_no_cone(elevation):
    with pytest.raises(ArgumentError, match="elevation must lie"):
        cone_gram(2, "pixels", elevation)


def test_front_lights_leave_a_sphere_three_strong_modes():
    pca = lighting_pca(sphere_gram(8, "pixels"), front_lights(8))
    assert pca.cumulative[2] > 0.94
