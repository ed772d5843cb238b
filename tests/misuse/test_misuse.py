"""Arrays that are not what was asked for: as good as the right ones, or refused by name."""

from dataclasses import dataclass

import numpy as np
import pytest

from harmface import (
    conventions,
    geometry,
    inverse,
    light,
    pca,
    recognition,
    rendering,
    sphere,
    stereo,
)
from harmface.errors import HarmfaceError

RNG = np.random.default_rng(0)
GRID = sphere.fibonacci_directions(60).reshape(6, 10, 3)
FRONT = np.where(GRID[..., 2:] < 0.2, (0.0, 0.0, 1.0), GRID)
NINE = RNG.random((3, 9)) + np.eye(3, 9)
TURN = np.array([[0.0, -1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]])
PIXELS = RNG.random((5, 40)) + 0.1
IMAGES = RNG.random((3, 9, 40)) + 0.1
BASES = np.stack([np.linalg.qr(each.T)[0].T for each in IMAGES])
SQUARE = np.array([[0.0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]])
FACES = np.array([[0, 1, 2], [0, 2, 3]])
UP = np.tile([0.0, 0.0, 1.0], (4, 1))
DEPTH = RNG.random((6, 8))
MASK = np.ones((6, 8), bool)
Y, X = np.mgrid[1:-1:12j, -1:1:12j]
BALL = X**2 + Y**2 < 0.9
NORMALS = np.stack([X, Y, np.sqrt(np.where(BALL, 1 - X**2 - Y**2, 1))], axis=-1)
NORMALS = np.where(BALL[..., None], NORMALS, (0.0, 0.0, 1.0))
LAMPS = sphere.fibonacci_directions(40)[:12]
STACK = np.maximum(NORMALS @ LAMPS.T, 0).transpose(2, 0, 1) * BALL + 1e-3

CALLS = {
    "directions_from_angles": (
        conventions.directions_from_angles,
        {"polar": RNG.random(4), "azimuth": RNG.random(4)},
    ),
    "angles_from_directions": (conventions.angles_from_directions, {"directions": GRID}),
    "luminance": (conventions.luminance, {"rgb": RNG.random((4, 3))}),
    "srgb_to_linear": (conventions.srgb_to_linear, {"encoded": RNG.random((4, 3))}),
    "linear_to_srgb": (conventions.linear_to_srgb, {"linear": RNG.random((4, 3))}),
    "real_harmonics": (
        lambda directions: sphere.real_harmonics(directions, 4),
        {"directions": GRID},
    ),
    "complex_harmonics": (
        lambda directions: sphere.complex_harmonics(directions, 3),
        {"directions": GRID},
    ),
    "real_to_complex": (sphere.real_to_complex, {"coefficients": NINE}),
    "energy_per_degree": (sphere.energy_per_degree, {"coefficients": NINE}),
    "rotate": (sphere.rotate, {"coefficients": NINE, "rotation": TURN}),
    "rotate_zonal": (
        sphere.rotate_zonal,
        {"zonal": RNG.random(4), "axis": np.array([0.0, 0.6, 0.8])},
    ),
    "synthesize": (sphere.synthesize, {"coefficients": NINE, "directions": GRID}),
    "DistantLight": (
        lambda directions, irradiances: light.DistantLight(directions, irradiances).irradiances,
        {"directions": GRID[0], "irradiances": RNG.random((3, 10))},
    ),
    "from_image": (
        lambda radiance: light.EnvironmentMap.from_image(radiance).radiance,
        {"radiance": RNG.random((4, 8, 3))},
    ),
    "add_lights": (lambda coefficients: light.add_lights(coefficients), {"coefficients": NINE}),
    "ambient": (lambda radiance: light.ambient(radiance, 2), {"radiance": RNG.random(3)}),
    "cone": (
        lambda direction, radiance: light.cone(direction, 0.3, radiance, 2),
        {"direction": np.array([0.0, 0.6, 0.8]), "radiance": RNG.random(3)},
    ),
    "transformed": (light.transformed, {"coefficients": NINE, "matrix": TURN}),
    "windowed": (light.windowed, {"coefficients": NINE, "window": np.array([1.0, 0.8, 0.4])}),
    "sample": (
        lambda directions: (
            light.sample(light.EnvironmentMap.from_image(RNG.random((4, 8))), directions).shape
        ),
        {"directions": GRID},
    ),
    "ProbeGrid": (
        lambda origin, spacing, coefficients: (
            light.ProbeGrid(origin, spacing, coefficients).coefficients
        ),
        {"origin": np.zeros(3), "spacing": np.ones(3), "coefficients": RNG.random((2, 2, 2, 9))},
    ),
    "gaunt product": (sphere.product, {"first": NINE, "second": NINE[::-1].copy()}),
    "triple_product": (
        sphere.triple_product,
        {"first": NINE, "second": NINE, "third": RNG.random((3, 4))},
    ),
    "multiplication_matrix": (
        lambda coefficients: sphere.multiplication_matrix(coefficients, 1, 2),
        {"coefficients": NINE},
    ),
    "harmonic_gradients": (
        lambda directions: sphere.harmonic_gradients(directions, 3),
        {"directions": GRID},
    ),
    "PolygonLight": (
        lambda vertices, radiance: (
            light.PolygonLight(vertices, radiance).probes(np.ones((1, 3)), 2).coefficients
        ),
        {"vertices": SQUARE, "radiance": RNG.random(3)},
    ),
    "DiscLight": (
        lambda center, normal, radiance: (
            light.DiscLight(center, normal, 0.3, radiance).probes(np.ones((1, 3)), 2).coefficients
        ),
        {"center": np.zeros(3), "normal": np.array([0.0, 0.6, 0.8]), "radiance": RNG.random(3)},
    ),
    "SphereLight": (
        lambda center, radiance: (
            light.SphereLight(center, 0.3, radiance).probes(np.ones((1, 3)), 2).coefficients
        ),
        {"center": np.zeros(3), "radiance": RNG.random(3)},
    ),
    "Probes": (
        lambda positions, coefficients, gradients: light.Probes(
            positions, coefficients, gradients
        ).at(np.ones((2, 3))),
        {
            "positions": RNG.random((2, 3)),
            "coefficients": RNG.random((2, 9)),
            "gradients": RNG.random((2, 9, 3)),
        },
    ),
    "farthest_points": (
        lambda candidates: light.farthest_points(candidates, 3),
        {"candidates": RNG.random((9, 3))},
    ),
    "transfer": (
        lambda albedo: (
            rendering.transfer(
                geometry.Mesh(SQUARE, FACES, UP, np.full((4, 3), 0.5)),
                1,
                bounces=1,
                albedo=albedo,
                samples=32,
            ).coefficients
        ),
        {"albedo": RNG.random(4)},
    ),
    "clamped_cosines": (rendering.clamped_cosines, {"normals": GRID, "directions": GRID[0]}),
    "harmonic_images": (
        rendering.harmonic_images,
        {"normals": GRID, "albedo": RNG.random((6, 10))},
    ),
    "relight": (rendering.relight, {"lighting": NINE, "basis": RNG.random((9, 4, 5))}),
    "harmonic_irradiance": (rendering.harmonic_irradiance, {"coefficients": NINE, "normals": GRID}),
    "polynomial_irradiance": (
        rendering.polynomial_irradiance,
        {"coefficients": NINE, "normals": GRID},
    ),
    "irradiance_matrix": (rendering.irradiance_matrix, {"coefficients": NINE}),
    "outgoing_radiance": (rendering.outgoing_radiance, {"radiosity": DEPTH}),
    "box_average": (lambda images: rendering.box_average(images, 2), {"images": DEPTH}),
    "Mesh": (
        lambda **given: geometry.Mesh(**given).bounds,
        {"vertices": SQUARE, "faces": FACES, "normals": UP, "albedo": np.full((4, 3), 0.5)},
    ),
    "vertex_normals": (geometry.vertex_normals, {"vertices": SQUARE, "faces": FACES}),
    "depth_least_squares": (geometry.depth_least_squares, {"normals": NORMALS, "mask": BALL}),
    "depth_frankot_chellappa": (
        geometry.depth_frankot_chellappa,
        {"normals": NORMALS, "mask": BALL},
    ),
    "depth_to_mesh": (
        lambda depth, mask: geometry.depth_to_mesh(depth, mask).vertices,
        {"depth": DEPTH, "mask": MASK},
    ),
    "facing_camera": (geometry.facing_camera, {"normals": NORMALS, "mask": BALL}),
    "analytic_pca": (
        lambda normals, albedo: pca.analytic_pca(normals, albedo, max_degree=3).eigenvalues,
        {"normals": FRONT, "albedo": RNG.random((6, 10)) + 0.1},
    ),
    "empirical_pca": (
        lambda images: pca.empirical_pca(images, count=2).eigenvalues,
        {"images": PIXELS},
    ),
    "subspace_distances": (recognition.subspace_distances, {"probes": PIXELS, "bases": BASES}),
    "orthonormal_basis": (
        lambda images: recognition.orthonormal_basis(images, 9),
        {"images": IMAGES},
    ),
    "non_negative_distances": (
        recognition.non_negative_distances,
        {"probes": PIXELS, "images": IMAGES},
    ),
    "estimated_light": (
        recognition.estimated_light,
        {"probes": PIXELS[:3], "images": IMAGES},
    ),
    "margins": (recognition.margins, {"distances": PIXELS}),
    "Photographs": (
        lambda images: recognition.Photographs(np.array(["a", "b"]), images).images,
        {"images": RNG.random((2, 4, 5))},
    ),
    "angular_errors": (stereo.angular_errors, {"normals": GRID, "truth": GRID[::-1].copy()}),
    "without_rotation": (
        stereo.without_rotation,
        {"normals": GRID.reshape(-1, 3), "truth": GRID[::-1].reshape(-1, 3).copy()},
    ),
    "photometric_stereo": (
        lambda images, mask, light: (
            stereo.photometric_stereo(images, mask, method="known-lights", light=light).normals
        ),
        {"images": STACK, "mask": BALL, "light": LAMPS},
    ),
    "estimate_light": (
        lambda image, normals, albedo: inverse.estimate_light(image, normals, albedo).coefficients,
        {"image": STACK.mean(axis=0), "normals": NORMALS, "albedo": 1 + DEPTH[:1, :1] * BALL},
    ),
    "relight_photograph": (
        inverse.relight_photograph,
        {"photo": STACK[0], "before": STACK[1] + 1, "after": STACK[2] + 1, "mask": BALL},
    ),
    "photometric_stereo, light unknown": (
        lambda images, mask: stereo.photometric_stereo(images, mask, method="4d").normals,
        {"images": STACK, "mask": BALL},
    ),
}

ARGUMENTS = [(name, argument) for name, (_, given) in CALLS.items() for argument in given]


@dataclass
class ArrayLike:
    """What other libraries' arrays are to numpy."""

    values: np.ndarray

    def __array__(self, dtype=None, copy=None):
        return np.array(self.values, dtype=dtype)


AS_GOOD = {
    "a list": lambda array: array.tolist(),
    "a masked array without a mask": np.ma.masked_array,
    "an object with __array__": ArrayLike,
    "a read-only array": lambda array: np.frombuffer(array.tobytes(), array.dtype).reshape(
        array.shape
    ),
}


def holed(array):
    return np.ma.masked_array(array, mask=np.arange(array.size).reshape(array.shape) == 0)


def with_one(array, value):
    changed = array.astype(float)
    changed[tuple(side // 2 for side in changed.shape)] = value
    return changed


REFUSED = {
    "complex": lambda array: array + 1j,
    "objects": lambda array: np.full(array.shape, None),
    "dates": lambda array: np.zeros(array.shape, "datetime64[s]"),
    "text": lambda array: np.full(array.shape, "x"),
    "NaN": lambda array: with_one(array, np.nan),
    "Inf": lambda array: with_one(array, np.inf),
    "masked values": holed,
    "a ragged list": lambda array: [[1.0], [1.0, 2.0], "x"],
}


def same(one, other):
    return np.allclose(np.asarray(one, complex), np.asarray(other, complex), equal_nan=True)


@pytest.mark.parametrize(("name", "argument"), ARGUMENTS)
@pytest.mark.parametrize("kind", AS_GOOD)
def test_other_kinds_of_arrays_are_as_good(unchecked, name, argument, kind):
    function, given = CALLS[name]
    found = function(**{**given, argument: AS_GOOD[kind](given[argument])})
    assert same(found, function(**given))


@pytest.mark.parametrize(("name", "argument"), ARGUMENTS)
@pytest.mark.parametrize("kind", REFUSED)
def test_nonsense_is_refused_by_name(unchecked, name, argument, kind):
    function, given = CALLS[name]
    with pytest.raises(HarmfaceError, match=argument):
        function(**{**given, argument: REFUSED[kind](given[argument])})
