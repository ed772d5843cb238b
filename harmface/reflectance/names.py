"""Materials by a word, as the command line takes them."""

from collections.abc import Callable

from harmface.errors import ArgumentError
from harmface.reflectance.material import Material
from harmface.reflectance.matte import Lambert, OrenNayar
from harmface.reflectance.microfacet import GGX, Beckmann, TorranceSparrow
from harmface.reflectance.mirror import Mirror
from harmface.reflectance.phong import Blinn, Phong

MATERIALS: dict[str, Callable[..., Material]] = {
    "lambert": Lambert,
    "oren-nayar": OrenNayar,
    "phong": Phong,
    "blinn": Blinn,
    "ggx": GGX,
    "beckmann": Beckmann,
    "torrance-sparrow": TorranceSparrow,
    "mirror": Mirror,
}
"""Each with its one number: albedo, roughness, exponent or share."""

_OPTIONAL = ("lambert", "mirror")


def material_named(text: str) -> Material:
    """Return a material by its name and number, such as `phong:50`, `ggx:0.3` or `mirror`.

    Parameters
    ----------
    text
        `NAME:NUMBER`; for `lambert` and `mirror` the number may be left out.

    Returns
    -------
    Material
        With unit albedo, share or Fresnel reflectance unless the number says it.

    Raises
    ------
    ArgumentError
        If there is no such material, or its number is missing or out of range.

    Examples
    --------
    >>> material_named("phong:50")
    Phong(exponent=50.0, share=1.0)
    """
    name, colon, number = text.partition(":")
    if name not in MATERIALS:
        known = ", ".join(MATERIALS)
        raise ArgumentError(f"there is no material {name!r}; there are {known}, and merl:FILE")
    if not colon and name in _OPTIONAL:
        return MATERIALS[name]()
    try:
        value = float(number)
    except ValueError:
        raise ArgumentError(
            f"material {name} needs a number, such as {name}:0.3, got {text!r}"
        ) from None
    return MATERIALS[name](value)
