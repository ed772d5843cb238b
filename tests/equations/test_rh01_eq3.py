"""The nine harmonics of RH01 eq. 3, written out as printed."""

import numpy as np

from harmface.conventions import directions_from_angles, flat_index
from harmface.sphere import real_harmonics


def test_the_nine_harmonics_are_those_printed(rng):
    polar, azimuth = np.pi * rng.random(200), 2 * np.pi * rng.random(200)
    x, y, z = np.sin(polar) * np.cos(azimuth), np.sin(polar) * np.sin(azimuth), np.cos(polar)
    printed = {
        (0, 0): 0.282095 + 0 * x,
        (1, 1): 0.488603 * x,
        (1, 0): 0.488603 * z,
        (1, -1): 0.488603 * y,
        (2, 1): 1.092548 * x * z,
        (2, -1): 1.092548 * y * z,
        (2, -2): 1.092548 * x * y,
        (2, 0): 0.315392 * (3 * z**2 - 1),
        (2, 2): 0.546274 * (x**2 - y**2),
    }
    ours = real_harmonics(directions_from_angles(polar, azimuth), 2)
    for (degree, order), expected in printed.items():
        # Half a unit of the sixth decimal, times polynomials of at most 2.
        np.testing.assert_allclose(ours[flat_index(degree, order)], expected, atol=1e-6)
