import numpy as np

from harmface.enrollment.shading import (
    brightness,
    evenly_exposed,
    shading,
    slope_equations,
    usable,
)


def seen(hill, lights):
    return hill.images(lights).reshape(len(lights), -1), hill.slopes.reshape(2, -1)


def test_shading_times_brightness_is_the_photograph(hill, around):
    subject, lights = hill(1.0), around(40.0)
    images, slopes = seen(subject, lights)
    g = (subject.albedo * subject.normals[..., 2]).ravel()
    assert np.allclose(g * shading(lights, slopes), images, rtol=1e-12)
    assert np.allclose(brightness(images, usable(images), shading(lights, slopes)), g, rtol=1e-4)


def test_true_slopes_solve_the_equations_taken_at_them(hill, around):
    lights = around(30.0)
    images, slopes = seen(hill(1.0), lights)
    equations = slope_equations(images, lights, slopes, robust=True)
    left = np.einsum("ijm,jm->im", equations.matrix, slopes)
    # The eliminated brightness keeps a millionth in its denominator.
    assert np.allclose(left, equations.right, atol=1e-4 * np.abs(left).max())


def test_equations_step_towards_true_slopes_from_a_flat_start(hill, around):
    lights = around(10.0)
    images, slopes = seen(hill(1.0), lights)
    equations = slope_equations(images, lights, np.zeros_like(slopes), robust=False)
    found = np.linalg.solve(np.moveaxis(equations.matrix, 2, 0), equations.right.T[..., None])
    # Frontal light sees slopes to first order at once; sin(10) squared is 3 %.
    assert np.allclose(found[..., 0].T, slopes, atol=0.03)


def test_a_highlight_has_no_say(hill, around):
    lights = around(30.0)
    images, slopes = seen(hill(1.0), lights)
    shiny = images.copy()
    shiny[2, 100] += 1.0
    plain, robust = (slope_equations(shiny, lights, slopes, robust=each) for each in (False, True))
    off = [
        np.abs(each.matrix[:, :, 100] @ slopes[:, 100] - each.right[:, 100]).max()
        for each in (plain, robust)
    ]
    assert off[1] < off[0] / 20


def test_stronger_flashes_are_evened_out(hill, around, rng):
    lights = around(12.0)
    images, slopes = seen(hill(1.0), lights)
    strength = rng.uniform(0.97, 1.03, len(lights))
    evened = evenly_exposed(strength[:, None] * images, lights, slopes)
    ratio = evened.mean(axis=1) / images.mean(axis=1)
    assert np.ptp(ratio) < np.ptp(strength) / 10


def test_dark_pixels_hardly_count():
    weights = usable(np.array([[1.0] * 98 + [0.03, 0.003]]))
    assert weights[0, 0] > 0.99
    assert np.isclose(weights[0, 98], 0.5)
    assert weights[0, 99] < 0.01
