"""Small scenes whose images come from the clamped cosine, not from harmonics."""

from dataclasses import dataclass

import numpy as np
import pytest
from scipy.ndimage import binary_erosion
from scipy.spatial.transform import Rotation

from harmface.rendering import clamped_cosines
from harmface.sphere import fibonacci_directions
from harmface.stereo.cues import StructureField
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


class Quadric:
    """The front of an ellipsoid `p' Q p = 1`, in pixels: its normals and their derivatives.

    Albedo is one, so that the normals are the scaled normals too.
    """

    def __init__(self, semiaxes=(20.0, 15.0, 17.0), turn=(0.5, 0.3, 0.8), size=48, width=None):
        turned = Rotation.from_rotvec(turn).as_matrix()
        form = turned @ np.diag(1 / np.square(semiaxes)) @ turned.T
        y, x = np.mgrid[size - 1 : -size : -2, 1 - size : size : 2] / 2.0
        # g_z = Q_zz z + Q_xz x + Q_yz y is the root of this, and not negative in front.
        leaning = form[0, 2] * x + form[1, 2] * y
        flat = form[0, 0] * x**2 + 2 * form[0, 1] * x * y + form[1, 1] * y**2
        root = leaning**2 - form[2, 2] * (flat - 1)
        self.mask = root > 0
        if width is not None:
            self.mask &= (np.abs(x) < width / 2) & (np.abs(y) < width / 2)
        z = (np.sqrt(root[self.mask]) - leaning[self.mask]) / form[2, 2]
        self.places = np.stack([x[self.mask], y[self.mask], z], axis=1)
        gradient = self.places @ form
        length = np.linalg.norm(gradient, axis=1, keepdims=True)
        self.normals = gradient / length
        slopes = -gradient[:, :2] / gradient[:, 2:]
        self.along_x, self.along_y = (
            self._across((form[axis] + slopes[:, axis, None] * form[2]) / length) for axis in (0, 1)
        )

    def _across(self, change):
        return change - (self.normals * change).sum(axis=1, keepdims=True) * self.normals

    def field(self, frame=None, albedo=None, slope=(0.0, 0.0)):
        """Return the exact field of `v = frame b`, its cells being single pixels.

        Parameters
        ----------
        frame
            3 x 3, or d x 3.
        albedo, slope
            Of each pixel, and the derivatives of its logarithm.
        """
        frame = np.eye(3) if frame is None else frame
        a = np.ones(len(self.normals)) if albedo is None else albedo
        v = (a[:, None] * self.normals) @ frame.T
        along_x, along_y = (
            (a[:, None] * (change + by * self.normals)) @ frame.T
            for change, by in zip((self.along_x, self.along_y), slope, strict=True)
        )
        inner = binary_erosion(self.mask, iterations=3, border_value=1)[self.mask]
        one = np.ones(len(v))
        return StructureField(v, v, self.mask, one, v, along_x, along_y, 0 * one, inner)


def bas_relief(mu, nu, stretch):
    """Return the transformation (b_x + mu b_z, b_y + nu b_z, stretch b_z)."""
    return np.array([[1.0, 0, mu], [0, 1, nu], [0, 0, stretch]])


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
def egg():
    """A tilted ellipsoid seen whole."""
    return Quadric()


@pytest.fixture(scope="session")
def sphere():
    """A sphere seen whole."""
    return Quadric((20.0, 20.0, 20.0))


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
