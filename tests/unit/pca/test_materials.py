import numpy as np
import pytest

from harmface.errors import ArgumentError
from harmface.pca import materials_spectrum
from harmface.reflectance import Lambert, Phong
from harmface.reproduce import materials
from harmface.sphere import fibonacci_directions

NORMALS = fibonacci_directions(200)
NORMALS = NORMALS[NORMALS[:, 2] > 0.1]
TOWARDS = np.broadcast_to([0.0, 0.0, 1.0], NORMALS.shape)


def shares(material, power):
    rho = np.stack([each.coefficients(4, 4) for each in material])
    found = materials_spectrum(rho, power, NORMALS, TOWARDS)
    return np.cumsum(found) / found.sum()


def test_a_matte_material_has_nine_components_at_degree_2():
    assert shares([Lambert()], np.array([1.0, 1, 1, 0, 0]))[8] == pytest.approx(1)


def test_gloss_adds_components():
    power = np.ones(5)
    assert shares([Lambert()], power)[8] > shares([Lambert(), Phong(30)], power)[8] + 0.05


def test_theory_and_images_agree():
    assert materials.materials_pca(max_degree=4).values[0] < 0.02


def test_powers_of_other_number_are_refused():
    with pytest.raises(ArgumentError, match="materials must have shape"):
        materials_spectrum(np.ones((1, 2, 2, 2)), np.ones(3), NORMALS, TOWARDS)


def test_variance_of_white_light_on_a_matte_surface_is_known():
    # Radiance L_00 Y_00 at every pixel, of variance 1 / (4 pi).
    rho = Lambert().coefficients(0, 0)[None]
    found = materials_spectrum(rho, np.ones(1), NORMALS, TOWARDS)
    assert found[0] == pytest.approx(len(NORMALS) / (4 * np.pi), rel=1e-6)
