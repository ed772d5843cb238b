"""Every tool's own shading formula, written as its source has it, must give our irradiance."""

import numpy as np
import pytest
from scipy.special import sph_harm_y

from harmface.errors import ArgumentError
from harmface.light import windowed
from harmface.light.interchange import TOOLS, filament_window, tool_named
from harmface.rendering import harmonic_irradiance
from harmface.sphere import random_directions

NORMALS = random_directions(200, 0)
RNG = np.random.default_rng(1)
LIGHT = np.array([4.0, 3.5, 3.0])[:, None] * np.eye(1, 9) + 0.4 * RNG.standard_normal((3, 9))
PI = np.pi


def basis(n):
    """1, y, z, x, xy, yz, 3z2-1, xz, x2-y2 with the constants of the harmonics."""
    x, y, z = n.T
    return np.stack(
        [
            0.28209479177387814 + 0 * x,
            0.4886025119029199 * y,
            0.4886025119029199 * z,
            0.4886025119029199 * x,
            1.0925484305920792 * x * y,
            1.0925484305920792 * y * z,
            0.31539156525252005 * (3 * z * z - 1),
            1.0925484305920792 * x * z,
            0.5462742152960396 * (x * x - y * y),
        ]
    )


BANDS = np.array([PI, *3 * [2 * PI / 3], *5 * [PI / 4]])[:, None]
PHASE = np.array([1, -1, 1, -1, 1, -1, 1, -1, 1])[:, None]


def three_js(c, n):
    x, y, z = n.T
    h = [
        0.886227 + 0 * x, 2 * 0.511664 * y, 2 * 0.511664 * z, 2 * 0.511664 * x,
        2 * 0.429043 * x * y, 2 * 0.429043 * y * z, 0.743125 * z * z - 0.247708,
        2 * 0.429043 * x * z, 0.429043 * (x * x - y * y),
    ]  # fmt: skip
    return c.T @ np.stack(h)


def polynomial(c, n):
    x, y, z = n.T
    h = [1 + 0 * x, y, z, x, x * y, y * z, 3 * z * z - 1, z * x, x * x - y * y]
    return PI * (c.T @ np.stack(h))


def unity(c, n):
    x, y, z = n.T * np.array([[1], [1], [-1]])
    result = []
    for s in c:
        a = s[3] * x + s[1] * y + s[2] * z + (s[0] - s[6])
        b = s[4] * x * y + s[5] * y * z + 3 * s[6] * z * z + s[7] * z * x
        result.append(PI * (a + b + s[8] * (x * x - y * y)))
    return np.stack(result)


def deca(c, n):
    x, y, z = n.T
    f = np.array(
        [
            1 / np.sqrt(4 * PI),
            *3 * [(2 * PI / 3) * np.sqrt(3 / (4 * PI))],
            *3 * [(PI / 4) * 3 * np.sqrt(5 / (12 * PI))],
            (PI / 4) * 1.5 * np.sqrt(5 / (12 * PI)),
            (PI / 4) * 0.5 * np.sqrt(5 / (4 * PI)),
        ]
    )
    h = np.stack([1 + 0 * x, x, y, z, x * y, x * z, y * z, x**2 - y**2, 3 * z**2 - 1])
    return c.T @ (h * f[:, None])


def deep3d(c, n):
    x, y, z = n.T
    a = PI, 2 * PI / np.sqrt(3), 2 * PI / np.sqrt(8)
    k = 1 / np.sqrt(4 * PI), np.sqrt(3) / np.sqrt(4 * PI), 3 * np.sqrt(5) / np.sqrt(12 * PI)
    h = np.stack(
        [
            a[0] * k[0] + 0 * x,
            -a[1] * k[1] * y,
            a[1] * k[1] * z,
            -a[1] * k[1] * x,
            a[2] * k[2] * x * y,
            -a[2] * k[2] * y * z,
            0.5 * a[2] * k[2] / np.sqrt(3) * (3 * z**2 - 1),
            -a[2] * k[2] * x * z,
            0.5 * a[2] * k[2] * (x**2 - y**2),
        ]
    )
    return (c + 0.8 * np.eye(1, 9)) @ h


def dpr(c, n):
    x, y, z = n.T
    return (c @ (BANDS * basis(np.stack([x, -z, y], axis=1))))[None]


def sfsnet(c, n):
    order = [0, 2, 3, 1, 6, 7, 5, 8, 4]
    return c @ (BANDS * basis(n))[order]


def phased(frame):
    return lambda c, n: c @ (BANDS * PHASE * basis(n @ np.array(frame)))


def pyshtools(c, n):
    polar, azimuth = np.arccos(n[:, 2]), np.arctan2(n[:, 1], n[:, 0])
    total = np.zeros((len(c), len(n)))
    for l in range(c.shape[2]):  # noqa: E741
        for m in range(l + 1):
            value = sph_harm_y(l, m, polar, azimuth) * (-1) ** m * np.sqrt(4 * PI)
            value = value * (np.sqrt(2) if m else 1)
            total += BANDS[l * l, 0] * (c[:, 0, l, m, None] * value.real)
            total += BANDS[l * l, 0] * (c[:, 1, l, m, None] * value.imag)
    return total


def scipy(c, n):
    polar, azimuth = np.arccos(n[:, 2]), np.arctan2(n[:, 1], n[:, 0])
    values = [sph_harm_y(d, m, polar, azimuth) for d in range(3) for m in range(-d, d + 1)]
    return (c @ (BANDS * np.stack(values))).real


def healpy(c, n):
    polar, azimuth = np.arccos(n[:, 2]), np.arctan2(n[:, 1], n[:, 0])
    total = np.zeros((len(c), len(n)))
    index = 0
    for m in range(3):
        for l in range(m, 3):  # noqa: E741
            value = c[:, index, None] * sph_harm_y(l, m, polar, azimuth)
            total += BANDS[l * l, 0] * (2 if m else 1) * value.real
            index += 1
    return total


IDENTITY = np.eye(3)
LEFT = np.diag([1, 1, -1])
SHADERS = {
    "three.js": three_js,
    "pifu": three_js,
    "filament": polynomial,
    "filament-radiance": lambda c, n: phased(IDENTITY)(c.T, n),
    "unity": unity,
    "unreal": phased([[0, 1, 0], [0, 0, 1], [-1, 0, 0]]),
    "directx": phased(LEFT),
    "kaolin": phased(IDENTITY),
    "mitsuba": phased(IDENTITY),
    "pyshtools": pyshtools,
    "scipy": scipy,
    "healpy": healpy,
    "deca": deca,
    "deep3d": deep3d,
    "dpr": dpr,
    "sfsnet": sfsnet,
}


def light_for(name):
    return LIGHT[:1] if name == "dpr" else LIGHT


def test_every_tool_has_a_formula_here():
    assert set(SHADERS) == set(TOOLS)


@pytest.mark.parametrize("name", TOOLS)
def test_a_tool_shades_as_we_do(name):
    values = TOOLS[name].encode(light_for(name))
    expected = harmonic_irradiance(light_for(name), NORMALS)
    assert np.allclose(SHADERS[name](values, NORMALS), expected, atol=2e-5)


@pytest.mark.parametrize("name", TOOLS)
def test_there_and_back(name):
    tool = TOOLS[name]
    assert np.allclose(tool.decode(tool.encode(light_for(name))), light_for(name), atol=1e-12)
    assert tool.stored
    assert tool.source


def test_directions_of_engines():
    """Light from the right, from above and from the viewer, in the axes of each."""
    for name, axes in {
        "unreal": {(1, 0, 0): (0, 1, 0), (0, 1, 0): (0, 0, 1), (0, 0, 1): (-1, 0, 0)},
        "dpr": {(1, 0, 0): (1, 0, 0), (0, 1, 0): (0, 0, 1), (0, 0, 1): (0, -1, 0)},
    }.items():
        frame = TOOLS[name].frame
        for ours, theirs in axes.items():
            assert np.array_equal(frame @ np.array(theirs), np.array(ours))


def test_grey_light_is_grey_in_colour():
    assert np.ptp(TOOLS["deca"].encode(LIGHT[:1]), axis=1).max() == 0


def test_arrays_may_be_flat_or_in_a_batch_of_one():
    values = TOOLS["deca"].encode(LIGHT)
    assert np.allclose(TOOLS["deca"].decode(values.ravel()), LIGHT)
    assert np.allclose(TOOLS["deca"].decode(values[None]), LIGHT)


def test_degrees_beyond_the_second_are_left_out():
    more = np.concatenate([LIGHT, np.ones((3, 7))], axis=1)
    assert np.array_equal(TOOLS["three.js"].encode(more), TOOLS["three.js"].encode(LIGHT))


def test_filaments_window_fades_degrees():
    window = filament_window(3.0)
    assert np.allclose(window, [1, np.sinc(1 / 3) ** 4, np.sinc(2 / 3) ** 4])
    assert windowed(LIGHT, window).shape == LIGHT.shape
    assert filament_window(2.0)[2] == 0


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (lambda: tool_named("nobody"), "must be one of three.js, filament"),
        (lambda: TOOLS["deca"].decode(np.ones((3, 9))), "9 x 3, got shape"),
        (lambda: TOOLS["deca"].decode(np.ones(26)), "27 numbers"),
        (lambda: TOOLS["sfsnet"].decode(np.ones((9, 3))), "3 x 9, got shape"),
        (lambda: TOOLS["dpr"].decode(np.ones(8)), "9 numbers"),
        (lambda: TOOLS["unity"].decode(np.full((3, 9), np.nan)), "finite"),
        (lambda: TOOLS["kaolin"].decode(-np.ones((3, 9))), "dark on average"),
        (lambda: TOOLS["dpr"].encode(LIGHT), "has one channel"),
        (lambda: TOOLS["deca"].encode(LIGHT[:, :4]), "of 9 coefficients"),
        (lambda: TOOLS["healpy"].decode(np.ones(5, complex)), "6 for degree 2"),
        (lambda: TOOLS["pyshtools"].decode(np.ones((3, 3))), "n \\+ 1"),
    ],
)
@pytest.mark.usefixtures("unchecked")
def test_what_no_tool_writes_is_refused(call, message):
    with pytest.raises(ArgumentError, match=message):
        call()
