"""Small scenes whose images come from the clamped cosine, not from harmonics."""

from dataclasses import dataclass

import numpy as np
import pytest

from harmface.rendering import clamped_cosines
from harmface.sphere import fibonacci_directions
from harmface.stereo.stack import image_stack


@dataclass(frozen=True)
class Scene:
    """True structure over a mask."""

    mask: np.ndarray
    normals: np.ndarray
    albedo: np.ndarray

    @property
    def b(self):
        return self.normals * self.albedo[:, None]

    @property
    def null_vectors(self):
        return np.concatenate([np.ones((1, len(self.albedo))), self.normals.T]) * self.albedo

    def images(self, directions, weights):
        """Return F images over the pixels."""
        return weights @ clamped_cosines(self.b, directions)

    def stack(self, values):
        return image_stack(self.pictures(values), self.mask)

    def pictures(self, values):
        images = np.zeros((len(values), *self.mask.shape))
        images[:, self.mask] = values
        return images


def relief(size=40):
    """A height field without symmetry."""
    y, x = np.mgrid[1 : -1 : size * 1j, -1 : 1 : size * 1j]
    waves = (
        (3.0, 1.0, 0.2, 0.13),
        (-1.5, 3.5, 1.0, 0.14),
        (2.2, -2.8, 2.0, 0.12),
        (4.5, 2.0, 0, 0.06),
    )
    zx = sum(h * a * np.cos(a * x + c * y + d) for a, c, d, h in waves)
    zy = sum(h * c * np.cos(a * x + c * y + d) for a, c, d, h in waves)
    normals = np.stack([-zx, -zy, np.ones_like(x)], axis=-1).reshape(-1, 3)
    normals /= np.linalg.norm(normals, axis=1, keepdims=True)
    albedo = 0.6 + 0.2 * np.sin(9 * x + 2 * y) * np.cos(7 * y - 3 * x)
    return Scene(np.ones((size, size), bool), normals, albedo.ravel())


def bumpy_ball(size=40):
    """The front of a dented sphere with an occluding outline."""
    y, x = np.mgrid[1 : -1 : size * 1j, -1 : 1 : size * 1j] * 1.05
    mask = x**2 + y**2 < 0.97
    x, y = x[mask], y[mask]
    z = np.sqrt(1 - x**2 - y**2)
    # z = sqrt(1 - r^2) + (1 - r^2) (0.06 sin(4 x + y) + 0.04 sin(5 y - x)).
    swell = z**2
    dent = 0.06 * np.sin(4 * x + y) + 0.04 * np.sin(5 * y - x)
    dent_x = 0.24 * np.cos(4 * x + y) - 0.04 * np.cos(5 * y - x)
    dent_y = 0.06 * np.cos(4 * x + y) + 0.2 * np.cos(5 * y - x)
    zx = -x / z + swell * dent_x - 2 * x * dent
    zy = -y / z + swell * dent_y - 2 * y * dent
    normals = np.stack([-zx, -zy, np.ones_like(z)], axis=1)
    normals /= np.linalg.norm(normals, axis=1, keepdims=True)
    return Scene(mask, normals, 0.6 + 0.2 * np.sin(9 * x + 2 * y) * np.cos(7 * y - 3 * x))


def front_lights(count):
    """Unit directions spread over the hemisphere of the viewer."""
    directions = fibonacci_directions(2 * count)
    return directions[directions[:, 2] > 0][:count]


@pytest.fixture(scope="session")
def hills():
    return relief()


@pytest.fixture(scope="session")
def ball():
    return bumpy_ball()


@pytest.fixture(scope="session")
def single_lights():
    return front_lights(24)


@pytest.fixture(scope="session")
def several_sources(ball):
    """Two point sources an image, and uniform light."""
    rng = np.random.default_rng(6)
    weights = np.eye(80)[:32] + 0.7 * np.eye(80)[rng.permutation(45)[:32]]
    images = ball.images(fibonacci_directions(80), weights) + 0.3 * ball.albedo
    return images * (1 + 0.01 * rng.standard_normal(images.shape))
