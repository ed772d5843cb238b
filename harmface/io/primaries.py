"""Pictures in the colours of other primaries, brought to those of Rec. 709 and sRGB."""

import warnings
from pathlib import Path

import numpy as np
from jaxtyping import Float

from harmface.errors import ArgumentError, FileWarning

REC709 = (0.64, 0.33, 0.30, 0.60, 0.15, 0.06, 0.3127, 0.3290)
"""Chromaticities x, y of red, green, blue and white (ITU-R BT.709)."""

XYZ = (1.0, 0.0, 0.0, 1.0, 0.0, 0.0, 1 / 3, 1 / 3)
"""Chromaticities of CIE XYZ itself."""

SAME = 2e-3
"""Chromaticities that differ by less are the same, rounded to the usual three digits."""

# Bradford: XYZ to responses of the eye's cones, sharpened (Lam 1985).
_CONES = np.array([[0.8951, 0.2664, -0.1614], [-0.7502, 1.7135, 0.0367], [0.0389, -0.0685, 1.0296]])


def to_rec709(chromaticities: tuple[float, ...]) -> Float[np.ndarray, "3 3"] | None:
    """Return the matrix that turns linear values of some primaries to Rec. 709.

    What is white, equal in all three channels, stays so: the white points are matched (Bradford).
    XYZ are no primaries with a white of their own; they are only expressed in Rec. 709, so that
    Y is the luminance of the result.

    Parameters
    ----------
    chromaticities
        x and y of red, green, blue and white.

    Returns
    -------
    numpy.ndarray or None
        For column vectors; None if the primaries are those of Rec. 709.

    Raises
    ------
    ArgumentError
        If the chromaticities are those of no primaries.

    Examples
    --------
    >>> to_rec709(XYZ).round(3)
    array([[ 3.241, -1.537, -0.499],
           [-0.969,  1.876,  0.042],
           [ 0.056, -0.204,  1.057]])
    """
    given = np.array(chromaticities, dtype=np.float64)
    if np.abs(given - REC709).max(initial=0) < SAME:
        return None
    target = np.linalg.inv(_to_xyz(np.array(REC709)))
    if np.abs(given - XYZ).max() < SAME:
        return target
    source = _to_xyz(given)
    whites = _CONES @ np.stack([source.sum(axis=1), np.linalg.inv(target).sum(axis=1)], axis=1)
    if not (whites > 0).all():
        raise ArgumentError(f"chromaticities must be those of some colours, got {given.tolist()}")
    match = np.linalg.inv(_CONES) @ np.diag(whites[:, 1] / whites[:, 0]) @ _CONES
    return np.asarray(target @ match @ source)


def in_rec709(
    path: Path | str, image: Float[np.ndarray, "H W 3"], matrix: Float[np.ndarray, "3 3"]
) -> Float[np.ndarray, "H W 3"]:
    """Return a file's picture in Rec. 709, without what makes a channel of light negative.

    Colours more saturated than the primaries of Rec. 709 are negative in one of them. A light is
    not: there the channel is set to 0, and that it was is said. Where the file itself holds
    negative values they are kept.

    Parameters
    ----------
    path
        Named in the warning.
    image
        As the file has it.
    matrix
        Of `to_rec709`.

    Warns
    -----
    FileWarning
        If there are such colours.
    """
    found = image @ matrix.T.astype(np.float32)
    light = image.min(axis=-1) >= 0
    rounding = 8 * np.finfo(np.float32).eps * found.max(axis=-1)
    share = (light & (found.min(axis=-1) < -rounding)).mean()
    found[(found < 0) & light[..., None]] = 0
    if share:
        warnings.warn(
            f"{path}: {share:.2%} of its pixels have colours beyond Rec. 709, negative in a "
            "channel, which is set to 0",
            FileWarning,
            stacklevel=3,
        )
    return found


def luminance_weights(chromaticities: tuple[float, ...]) -> Float[np.ndarray, "3"]:
    """Return the share of red, green and blue of some primaries in the luminance Y."""
    return np.asarray(_to_xyz(np.array(chromaticities))[1])


def _to_xyz(chromaticities: Float[np.ndarray, "8"]) -> Float[np.ndarray, "3 3"]:
    """Return the matrix from linear values to XYZ, white having Y = 1."""
    x, y = chromaticities.reshape(4, 2).T
    columns = np.stack([x, y, 1 - x - y])
    # The determinant is twice the area of the primaries' triangle: of three in a line, which are
    # rounded, it is small.
    if not (np.isfinite(columns).all() and abs(np.linalg.det(columns[:, :3])) > SAME and y[3] > 0):
        raise ArgumentError(
            f"chromaticities must be those of three colours, got {chromaticities.tolist()}"
        )
    strengths = np.linalg.solve(columns[:, :3], columns[:, 3] / y[3])
    return np.asarray(columns[:, :3] * strengths)
