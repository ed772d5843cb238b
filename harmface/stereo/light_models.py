"""How light makes an image of scaled normals: harmonics, point lights, or many directions.

Each model predicts images `f_i(b_p)` of light parameters (a row an image) and scaled normals b
= albedo n, and differentiates them. All are homogeneous in b, so exposure and albedo share one
scale.
"""

from dataclasses import dataclass
from typing import Protocol, TypeGuard, runtime_checkable

import numpy as np
from jaxtyping import Float

from harmface.stereo.homogeneous import scaled_normal_images, scaled_normal_images_with_jacobian


@runtime_checkable
class LightModel(Protocol):
    """Images as a function of light parameters and scaled normals."""

    def predict(
        self, light: Float[np.ndarray, "F q"], b: Float[np.ndarray, "p 3"]
    ) -> Float[np.ndarray, "F p"]:
        """Return the images."""

    def by_light(
        self, light: Float[np.ndarray, "F q"], b: Float[np.ndarray, "p 3"]
    ) -> Float[np.ndarray, "F q p"]:
        """Return the derivatives by the light parameters of each image."""

    def by_normal(
        self, light: Float[np.ndarray, "F q"], b: Float[np.ndarray, "p 3"]
    ) -> Float[np.ndarray, "F p 3"]:
        """Return the derivatives by the scaled normal of each pixel."""


@dataclass(frozen=True)
class HarmonicLight:
    """Light as harmonic coefficients of radiance: `f = L S(b)`.

    Parameters
    ----------
    degree
        Highest degree.
    """

    degree: int

    def predict(
        self, light: Float[np.ndarray, "F q"], b: Float[np.ndarray, "p 3"]
    ) -> Float[np.ndarray, "F p"]:
        """Return `L S(b)`."""
        return light @ scaled_normal_images(b, self.degree)

    def by_light(
        self, light: Float[np.ndarray, "F q"], b: Float[np.ndarray, "p 3"]
    ) -> Float[np.ndarray, "F q p"]:
        """Return S(b), the same for every image."""
        images = scaled_normal_images(b, self.degree)
        return np.broadcast_to(images, (len(light), *images.shape))

    def by_normal(
        self, light: Float[np.ndarray, "F q"], b: Float[np.ndarray, "p 3"]
    ) -> Float[np.ndarray, "F p 3"]:
        """Return `L dS/db`."""
        return np.tensordot(light, scaled_normal_images_with_jacobian(b, self.degree)[1], axes=1)


@dataclass(frozen=True)
class PointLights:
    """Distant points, and light all around: `f = sum_j max(b . l_j, 0) + a |b| + g . b`.

    The parameters of an image are the `3 count` components of its points l_j, each a direction
    times an irradiance, and then, if there is light all around, its gradient g, which makes it
    stronger from one side as a sky is, and a, its irradiance without. A point or gradient of zero
    is switched off: it has no derivative either.

    Parameters
    ----------
    count
        Points of each image.
    ambient
        Whether there is light all around.
    """

    count: int
    ambient: bool

    def points(self, light: Float[np.ndarray, "F q"]) -> Float[np.ndarray, "F n 3"]:
        """Return the points of each image."""
        return light[:, : 3 * self.count].reshape(len(light), self.count, 3)

    def gradient(self, light: Float[np.ndarray, "F q"]) -> Float[np.ndarray, "F 3"]:
        """Return the gradient of the light all around of each image."""
        return light[:, -4:-1]

    def predict(
        self, light: Float[np.ndarray, "F q"], b: Float[np.ndarray, "p 3"]
    ) -> Float[np.ndarray, "F p"]:
        """Return the sum of what the points and the light all around give."""
        images = sum(np.maximum(point @ b.T, 0) for point in self.points(light).swapaxes(0, 1))
        if self.ambient:
            images = images + light[:, -1:] * np.linalg.norm(b, axis=1) + self.gradient(light) @ b.T
        return np.asarray(images)

    def by_light(
        self, light: Float[np.ndarray, "F q"], b: Float[np.ndarray, "p 3"]
    ) -> Float[np.ndarray, "F q p"]:
        """Return b where a point is above the horizon, b if there is a gradient, and |b|."""
        lit = np.tensordot(self.points(light), b.T, axes=1) > 0
        slope = np.empty((*light.shape, len(b)))
        rows = slope[:, : 3 * self.count].reshape(len(light), self.count, 3, len(b))
        np.multiply(lit[:, :, None], b.T, out=rows)
        if self.ambient:
            changing = np.any(self.gradient(light) != 0, axis=1, keepdims=True)
            slope[:, -4:-1] = np.where(changing[..., None], b.T, 0)
            slope[:, -1] = np.linalg.norm(b, axis=1)
        return slope

    def by_normal(
        self, light: Float[np.ndarray, "F q"], b: Float[np.ndarray, "p 3"]
    ) -> Float[np.ndarray, "F p 3"]:
        """Return the sum of the points above the horizon, and `a b / |b| + g`."""
        points = self.points(light)
        lit = np.tensordot(points, b.T, axes=1) > 0
        # A product an image: einsum takes fifteen times as long.
        slope = lit.astype(b.dtype).swapaxes(1, 2) @ points
        if self.ambient:
            length = np.maximum(np.linalg.norm(b, axis=1, keepdims=True), np.finfo(b.dtype).tiny)
            slope += light[:, -1:, None] * (b / length) + self.gradient(light)[:, None]
        return slope


@dataclass(frozen=True, eq=False)
class DenseLight:
    """Irradiance from each of many directions, and uniform light: `f = W max(D b, 0) + a |b|`.

    The parameters of an image are W, an irradiance a direction, and a last.

    Parameters
    ----------
    directions
        Unit vectors.
    """

    directions: Float[np.ndarray, "J 3"]

    def predict(
        self, light: Float[np.ndarray, "F q"], b: Float[np.ndarray, "p 3"]
    ) -> Float[np.ndarray, "F p"]:
        """Return the weighted sum of what each direction gives."""
        return light @ self.columns(b)

    def columns(self, b: Float[np.ndarray, "p 3"]) -> Float[np.ndarray, "q p"]:
        """Return the image that each parameter gives alone."""
        length = np.linalg.norm(b, axis=1)
        return np.concatenate([np.maximum(self.directions @ b.T, 0), length[None]])

    def by_light(
        self, light: Float[np.ndarray, "F q"], b: Float[np.ndarray, "p 3"]
    ) -> Float[np.ndarray, "F q p"]:
        """Return the image of each parameter, the same for every image."""
        columns = self.columns(b)
        return np.broadcast_to(columns, (len(light), *columns.shape))

    def by_normal(
        self, light: Float[np.ndarray, "F q"], b: Float[np.ndarray, "p 3"]
    ) -> Float[np.ndarray, "F p 3"]:
        """Return the sum of the lights above the horizon."""
        lit = (self.directions @ b.T > 0).astype(b.dtype)
        slope = np.stack([(light[:, :-1] * axis) @ lit for axis in self.directions.T], axis=-1)
        length = np.maximum(np.linalg.norm(b, axis=1, keepdims=True), np.finfo(b.dtype).tiny)
        return slope + light[:, -1:, None] * (b / length)


@dataclass(frozen=True, eq=False)
class Mapped:
    """A model of what a linear map makes of the scaled normals: `f(l, A b)`.

    Light that a fit found belongs to its own choice of the linear map that images leave open.

    Parameters
    ----------
    model
        The model f.
    map
        A.
    """

    model: LightModel
    map: Float[np.ndarray, "3 3"]

    def predict(
        self, light: Float[np.ndarray, "F q"], b: Float[np.ndarray, "p 3"]
    ) -> Float[np.ndarray, "F p"]:
        """Return the images of A b."""
        return self.model.predict(light, b @ self.map.T)

    def by_light(
        self, light: Float[np.ndarray, "F q"], b: Float[np.ndarray, "p 3"]
    ) -> Float[np.ndarray, "F q p"]:
        """Return the model's derivatives at A b."""
        return self.model.by_light(light, b @ self.map.T)

    def by_normal(
        self, light: Float[np.ndarray, "F q"], b: Float[np.ndarray, "p 3"]
    ) -> Float[np.ndarray, "F p 3"]:
        """Return the model's derivatives at A b, times A."""
        return self.model.by_normal(light, b @ self.map.T) @ self.map


def has_one_point(model: LightModel) -> TypeGuard[PointLights]:
    """Return whether light comes from one point in each image, uniform light aside."""
    return isinstance(model, PointLights) and model.count == 1


def has_several_points(model: LightModel) -> TypeGuard[PointLights]:
    """Return whether light may come from several points in each image."""
    return isinstance(model, PointLights) and model.count > 1


def is_single(model: LightModel) -> bool:
    """Return whether light comes from one point in each image, and nowhere else."""
    return has_one_point(model) and not model.ambient


def uniform_share(model: LightModel, light: Float[np.ndarray, "F q"]) -> float:
    """Return the share of uniform light in the mean irradiance of points and uniform light.

    The median over the images: in a few of them points may be taken for it.
    """
    if not (isinstance(model, PointLights) and model.ambient):
        return 0.0
    # A point gives a quarter of its irradiance on average over all normals.
    points = np.linalg.norm(model.points(light), axis=2).sum(axis=1) / 4
    uniform = np.maximum(light[:, -1], 0)
    return float(np.median(uniform / np.maximum(points + uniform, np.finfo(np.float64).tiny)))
