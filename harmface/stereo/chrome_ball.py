"""Directions to lamps from photographs of a mirror sphere.

The camera looks along -z from afar, v = (0, 0, 1) being the direction back to it. What is seen at a
point of the sphere with normal n lies in the direction

    l = 2 (n . v) n - v,

so a lamp shows where n is halfway between l and v. The normal of the highlight is *not* the
direction to the lamp: that is twice as far from the axis. At the distance rho (in radii) from the
centre of the disc the angle from the axis is `2 asin(rho)`, and equal areas of the disc are equal
solid angles. So the mean of the directions that a highlight's pixels look at, weighted by their
brightness, is the middle of the lamp whatever its size, while the middle of the pixels is not.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from jaxtyping import Bool, Float
from scipy.ndimage import binary_fill_holes, label
from scipy.optimize import least_squares
from skimage.measure import find_contours

from harmface import checks
from harmface.errors import ArgumentError
from harmface.light.layouts import MirrorBall

ROUND = 0.03
"""Median distance of an outline from its circle, in radii, from which it is no sphere's. Outlines
drawn by hand keep within a hundredth."""

DRAWN = 0.5
"""Distance from the circle, pixels, that drawing in whole pixels gives an outline."""

WIDEST = 20.0
"""Radius, degrees, beyond which what shines is no lamp in one direction."""

FEWEST_PIXELS = 5.0
"""Smallest radius of a sphere: a pixel is worth 23 degrees on it."""

STILL = 3
"""Photographs from which what all of them show alike is no lamp's."""


@dataclass(frozen=True, eq=False)
class MirrorSphere:
    """What a mirror sphere tells of the lamps.

    Parameters
    ----------
    directions
        Unit vector from the sphere to the lamp of each photograph.
    degrees_per_pixel
        How far each turns if its highlight, or the sphere's outline, is off by a pixel along the
        radius, where that matters most.
    centre
        Row and column of the sphere's middle; pixel centres lie at half-integers.
    radius
        Of the sphere, pixels.
    """

    directions: Float[np.ndarray, "F 3"]
    degrees_per_pixel: Float[np.ndarray, "F"]
    centre: tuple[float, float]
    radius: float


def directions_from_mirror_sphere(
    images: Float[np.ndarray, "F H W"],
    mask: Bool[np.ndarray, "H W"],
    *,
    names: Sequence[str] | None = None,
) -> MirrorSphere:
    """Return the directions to the lamps that a mirror sphere shows, see the module's text.

    A circle is fitted to the outline of the mask. In each photograph the highlight is the connected
    part above half of the largest value that has most of the light; from three photographs on, what
    all of them show, such as a window, is taken off first. Clipped highlights serve as well.

    Parameters
    ----------
    images
        Photographs of the sphere, one lamp each; they need not be linear.
    mask
        The sphere's disc. Parts of its outline may be hidden.
    names
        Of the photographs, for messages; numbers from 1 if not given.

    Returns
    -------
    MirrorSphere
        Unit directions, degrees that a pixel is worth, and the circle in pixels.

    Raises
    ------
    ArgumentError
        If sizes differ, the mask is no disc, or a photograph shows no clear highlight: none, one
        wider than a lamp, or several.
    """
    images = checks.non_negative("images", images)
    if images.ndim != 3 or not len(images):
        raise ArgumentError(f"images must have shape (F, H, W), got {images.shape}")
    # What is bright on the sphere may have been painted black on its mask.
    mask = np.asarray(binary_fill_holes(checks.mask("mask", mask, images.shape[1:])))
    if names is None:
        names = [f"photograph {number}" for number in range(1, len(images) + 1)]
    if len(names) != len(images):
        raise ArgumentError(f"names must be one for each of {len(images)} images, got {len(names)}")
    row, column, radius = _circle(mask)
    rows, columns = np.indices(mask.shape) + 0.5
    disc = mask & (np.hypot(rows - row, columns - column) < radius)
    # The layout's own disc has the radius 1 in a square of side 2.
    looks = MirrorBall().directions_at(
        (rows - row) / radius + 1, (columns - column) / radius + 1, height=2
    )
    steady = images.min(axis=0) if len(images) >= STILL else 0.0
    directions = np.array(
        [
            _towards_the_lamp(np.where(disc, image - steady, 0.0), looks, name)
            for image, name in zip(images, names, strict=True)
        ]
    )
    # cos(theta / 2) is the normal's z: d theta / d rho = 2 / cos(theta / 2).
    halfway = np.sqrt((1 + directions[:, 2]) / 2)
    worth = np.degrees(2 / (radius * np.maximum(halfway, 1 / radius)))
    return MirrorSphere(directions, worth, (row, column), radius)


def _circle(mask: Bool[np.ndarray, "H W"]) -> tuple[float, float, float]:
    """Return row, column and radius of the circle that most of an outline lies on."""
    if not mask.any():
        raise ArgumentError("mask must cover the mirror sphere, got an empty one")
    # Outlines run between the centres of pixels inside and outside; not along the picture's edge.
    outline = np.concatenate([np.zeros((0, 2)), *find_contours(mask.astype(float), 0.5)]) + 0.5
    size = float(np.sqrt(mask.sum() / np.pi))
    start = np.array([*np.argwhere(mask).mean(axis=0) + 0.5, size])

    def off(circle: Float[np.ndarray, "3"]) -> Float[np.ndarray, "n"]:
        return np.hypot(*(outline - circle[:2]).T) - circle[2]

    if len(outline) < 3:
        raise ArgumentError("mask must show the outline of the mirror sphere, but has none")
    # Cauchy's loss forgets what hides the sphere, but only from near enough.
    near = least_squares(off, start, loss="soft_l1", f_scale=DRAWN)
    fit = least_squares(off, near.x, loss="cauchy", f_scale=DRAWN)
    row, column, radius = (float(each) for each in fit.x)
    if radius < FEWEST_PIXELS:
        raise ArgumentError(
            f"mask must be the disc of the mirror sphere, at least {FEWEST_PIXELS:g} pixels in "
            f"radius, got {radius:.1f}; take it from nearer"
        )
    if float(np.median(np.abs(off(fit.x)))) > ROUND * radius:
        raise ArgumentError(
            "mask must be the disc of the mirror sphere, but its outline is no circle; paint the "
            "sphere white and all else black"
        )
    return row, column, radius


def _towards_the_lamp(
    image: Float[np.ndarray, "H W"], looks: Float[np.ndarray, "H W 3"], name: str
) -> Float[np.ndarray, "3"]:
    """Return the direction to the lamp of one photograph, the sphere's surroundings being dark."""
    level = image.max() / 2
    bright = image > level
    parts, count = label(bright, np.ones((3, 3)))
    if not count:
        raise ArgumentError(f"{name}: shows no highlight on the mirror sphere; leave it out")
    light = np.bincount(parts[bright], image[bright])
    if 1.5 * light.max() < light.sum():
        raise ArgumentError(
            f"{name}: shows no clear highlight on the mirror sphere, but {count} bright parts of "
            "which none has two thirds of the light; leave it out, or darken the room"
        )
    highlight = parts == light.argmax()
    weight = image[highlight] - level
    middle = weight @ looks[highlight] / weight.sum()
    length = float(np.linalg.norm(middle))
    # The mean of a cap of radius a has the length (1 + cos a) / 2.
    if length < (1 + np.cos(np.radians(WIDEST))) / 2:
        raise ArgumentError(
            f"{name}: shows no clear highlight on the mirror sphere: what is bright on it is wider "
            f"than {2 * WIDEST:.0f} degrees; is it a mirror?"
        )
    return middle / length
