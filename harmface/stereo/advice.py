"""What a person should know and can do about a surface found under unknown light."""

import numpy as np
from jaxtyping import Float

from harmface.stereo.homogeneous import directions_of
from harmface.stereo.result import Recovered

VAGUE = 8.0
"""Degrees of tilt from which a surface looks turned."""

STRETCHED = 0.25
"""Relative error of the depth from which a surface looks flattened or swollen."""

NARROW = 25.0
"""Degrees about their mean within which lamps tell little of the tilt."""

UNEQUAL = 1.5
"""Ratio of the strongest tenth of the lamps to the weakest that is worth a word."""


def relative_strengths(lamps: Float[np.ndarray, "F 3"]) -> tuple[float, ...]:
    """Return the lengths of lamps relative to their mean."""
    length = np.linalg.norm(lamps, axis=1)
    return tuple(float(each) for each in length / max(float(length.mean()), 1e-300))


def doubts(found: Recovered) -> tuple[str, ...]:
    """Return warnings that a person can act on.

    Parameters
    ----------
    found
        What a method recovered.
    """
    said: list[str] = []
    if found.lamps is not None:
        low, high = np.percentile(relative_strengths(found.lamps), [10, 90])
        if high > UNEQUAL * low:
            said.append(f"strengths of the lamps differ by {high / max(low, 1e-12):.1f} times")
    if found.of_map is not None:
        said += _of_the_map(found)
    if found.convexity == "assumed":
        said.append(
            "convex was assumed: no outline and no known normal tells a surface from its concave "
            "counterpart"
        )
    return tuple(said)


def _of_the_map(found: Recovered) -> list[str]:
    said = []
    assert found.of_map is not None
    for axis, tilt in zip("xy", found.of_map.tilt, strict=True):
        if tilt > VAGUE:
            remedy = "give one normal (normals_known), or photographs with light from elsewhere"
            where = ""
            if found.lamps is not None:
                where, remedy = _lamps_about(found.lamps, axis, remedy)
            said.append(f"{where}tilt about {axis} is uncertain by {tilt:.0f} degrees; {remedy}")
    if found.of_map.stretch > STRETCHED:
        said.append(
            f"the depth may be stretched by {found.of_map.stretch:.0%}; give one normal, or the "
            "directions of the lamps"
        )
    return said


def _lamps_about(lamps: Float[np.ndarray, "F 3"], axis: str, remedy: str) -> tuple[str, str]:
    """Return where narrow lamps lie, and where another would help."""
    n = directions_of(lamps)
    middle = directions_of(n.mean(axis=0))
    angle = float(np.degrees(np.arccos(np.clip(n @ middle, -1, 1))).max())
    if angle > NARROW:
        return "", remedy
    if axis == "x":
        side = "below" if middle[1] >= 0 else "above"
    else:
        side = "the left" if middle[0] >= 0 else "the right"
    place = ", ".join(f"{part:.2f}" for part in middle)
    where = f"all lamps lie within {angle:.0f} degrees of ({place}): "
    return where, f"add a lamp from {side}, or give one normal (normals_known)"
