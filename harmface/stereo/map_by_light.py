"""Which normals the four or nine dimensions mean, settled by light from points.

Harmonics explain photographs of attached shadows only nearly, and there is little that they lose
if every normal is changed by the same linear map and albedo by a function of the normal: it takes
10 to 30 percent from the rims. The cues read the map off albedo, so it comes out wrong by 5 to 10
degrees, while but for the map the normals are right to about one in nine dimensions and three in
four. Points, never negative, allow no such exchange, and a few images are enough to find them; the
linear functions of the dimensions that come nearest to the normals found so then serve all images.
"""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float

from harmface.stereo.cues import Knowledge
from harmface.stereo.evaluation import angular_errors
from harmface.stereo.homogeneous import directions_of, scaled_normal_images
from harmface.stereo.light_models import HarmonicLight
from harmface.stereo.linear_map import nearest_linear_map
from harmface.stereo.refinement import Refined, refine
from harmface.stereo.robust import robust_scale
from harmface.stereo.stack import ImageStack, spread_images

IMAGES = 64
"""Images that the map is found with, spread over all: more of them tell more than more pixels."""

PIXELS = 160
"""Pixels by which their light is found."""


@dataclass(frozen=True, eq=False)
class Settled:
    """Linear functions of the images' structure that give scaled normals.

    Parameters
    ----------
    directions
        Rows that take the images' structure to vectors along the normals.
    albedo
        Row that takes it to albedo, the first of its harmonics.
    fit
        What both were read from.
    truncation_error
        Angle between the normals that the directions give and those of the fit, degrees: what
        the dimensions left out bend.
    """

    directions: Float[np.ndarray, "3 d"]
    albedo: Float[np.ndarray, "d"]
    fit: Refined
    truncation_error: Float[np.ndarray, "p"]

    def scaled_normals(self, structure: Float[np.ndarray, "d p"]) -> Float[np.ndarray, "p 3"]:
        """Return the scaled normals of a structure."""
        albedo = np.maximum(self.albedo @ structure, 0)
        return directions_of(structure.T @ self.directions.T) * albedo[:, None]


def settled_by_light(
    stack: ImageStack,
    structure: Float[np.ndarray, "d p"],
    b: Float[np.ndarray, "p 3"],
    knowledge: Knowledge,
    rng: np.random.Generator,
) -> Settled | None:
    """Return the linear functions of the structure that points choose.

    None if points explain no more than harmonics of degree 2 do, as under smooth surroundings.

    Parameters
    ----------
    stack
        Images, in float64.
    structure
        Their factor of four or nine dimensions.
    b
        Scaled normals of the first or second order.
    knowledge
        What else is known.
    rng
        Draws the pixels.
    """
    few = spread_images(stack, IMAGES)
    fit = refine(few, b, knowledge, rng=rng, pixels=PIXELS)
    if isinstance(fit.model, HarmonicLight):
        return None
    images = scaled_normal_images(b, 2)
    light = np.linalg.lstsq(images.T, few.values.T, rcond=None)[0].T
    by_harmonics = few.values - light @ images
    by_points = few.values - fit.model.predict(fit.light, fit.structure.T)
    if robust_scale(by_harmonics[few.seen]) <= robust_scale(by_points[few.seen]):
        return None
    length = np.linalg.norm(fit.b, axis=1)
    bright = (length > 0) & (structure != 0).any(axis=0)
    normals = fit.b[bright] / length[bright, None]
    relative = structure[:, bright] / length[bright]
    albedo = np.linalg.lstsq(relative.T, np.ones(len(normals)), rcond=None)[0]
    directions = nearest_linear_map(structure[:, bright].T, normals)
    bent = np.zeros(len(length))
    bent[bright] = angular_errors(directions_of(structure[:, bright].T @ directions.T), normals)
    return Settled(directions, albedo, fit, bent)
