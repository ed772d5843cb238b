"""The option that says what a surface is made of."""

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from harmface.cli.common import told

if TYPE_CHECKING:
    from harmface.reflectance import Material

MATERIAL_HELP = (
    "lambert, oren-nayar:ROUGHNESS, phong:EXPONENT, blinn:EXPONENT, ggx:ROUGHNESS, "
    "beckmann:ROUGHNESS, torrance-sparrow:ROUGHNESS, mirror, or merl:FILE (a measured one)."
)
MaterialOption = Annotated[str, typer.Option(metavar="NAME[:NUMBER]", help=MATERIAL_HELP)]


def load_material(text: str) -> "Material":
    """Return a material by name, or read a measured one; say on stderr what was not measured."""
    from harmface.io import read_merl
    from harmface.reflectance import material_named

    kind, _, rest = text.partition(":")
    if kind != "merl":
        return material_named(text)
    found = read_merl(Path(rest))
    with told() as tell:
        if found.missing:
            tell(f"{rest}: {found.missing} of {found.measured.size} entries were not measured")
    return found


def material_files(text: str | None) -> list[Path]:
    """Return the file that a material is read from, if any."""
    kind, _, rest = (text or "").partition(":")
    return [Path(rest)] if kind == "merl" else []
