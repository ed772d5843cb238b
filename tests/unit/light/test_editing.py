import numpy as np
import pytest

from harmface.errors import ArgumentError
from harmface.light import animate_coefficient, published_probe, scale_coefficient, set_coefficient
from harmface.rendering.irradiance import harmonic_irradiance

UP, DOWN, RIGHT = np.array([[0.0, 1.0, 0.0], [0.0, -1.0, 0.0], [1.0, 0.0, 0.0]])


def test_more_of_the_vertical_moment_lights_from_above():
    light = published_probe("grace")
    edited = scale_coefficient(light, 1, -1, 2.0)
    assert (harmonic_irradiance(edited, UP) > harmonic_irradiance(light, UP)).all()
    assert (harmonic_irradiance(edited, DOWN) < harmonic_irradiance(light, DOWN)).all()
    np.testing.assert_allclose(
        harmonic_irradiance(edited, RIGHT), harmonic_irradiance(light, RIGHT)
    )
    np.testing.assert_array_equal(light, published_probe("grace"))


def test_set_replaces_one_coefficient_of_each_channel():
    light = published_probe("eucalyptus")
    edited = set_coefficient(light, 2, 0, np.array([1.0, 2.0, 3.0]))
    np.testing.assert_array_equal(edited[:, 6], [1, 2, 3])
    np.testing.assert_array_equal(np.delete(edited, 6, 1), np.delete(light, 6, 1))


def test_animation_has_a_light_for_every_frame():
    light = published_probe("grace")
    frames = animate_coefficient(light, 1, 1, np.array([1.0, 0.0, -1.0]))
    assert frames.shape == (3, 3, 9)
    for frame, factor in zip(frames, (1, 0, -1), strict=True):
        np.testing.assert_array_equal(frame, scale_coefficient(light, 1, 1, float(factor)))


@pytest.mark.parametrize(
    "edit",
    [
        lambda light: set_coefficient(light, 3, 0, 1.0),
        lambda light: scale_coefficient(light, 3, 0, 1.0),
        lambda light: animate_coefficient(light, 3, 0, np.ones(2)),
        lambda light: set_coefficient(light, 1, 2, 1.0),
        lambda light: set_coefficient(light, 1, 0, np.nan),
        lambda light: scale_coefficient(light, 1, 0, np.inf),
        lambda light: animate_coefficient(light, 1, 0, np.array([np.nan])),
    ],
)
def test_edits_that_make_no_sense_are_refused(edit):
    with pytest.raises(ArgumentError):
        edit(published_probe("grace"))
