"""Files of light directions and intensities, as photometric stereo sets have them."""

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path, PurePosixPath

import numpy as np
from jaxtyping import Float

from harmface.conventions import light_direction
from harmface.errors import FileError
from harmface.io.files import excerpt
from harmface.io.tables import Table, read_table
from harmface.summaries import summary

UNIT = 0.02
"""Departure of a length from 1 that counts as a unit vector's: two decimals are off by 0.0087."""

UNEQUAL = 0.01
"""Relative spread of the directions' lengths from which they seem to mean something."""

_AXES, _ANGLES, _INTENSITY = ("x", "y", "z"), ("azimuth", "elevation"), "intensity"


@dataclass(frozen=True, eq=False)
class Lights:
    """One light for each image.

    Parameters
    ----------
    directions
        Unit vectors from the object to the light.
    distances
        Lengths that the file gave them: how far the lights are, if it holds positions.
    intensities
        Of each light, if the file gave them.
    notes
        What to know of how the file was read.
    """

    directions: Float[np.ndarray, "F 3"]
    distances: Float[np.ndarray, "F"]
    intensities: Float[np.ndarray, "F"] | None
    notes: tuple[str, ...] = ()

    __repr__ = summary


@dataclass(frozen=True, eq=False)
class _Reading:
    """One way to take a table of numbers for directions, of any length, and intensities."""

    how: str
    vectors: Float[np.ndarray, "F 3"]
    intensities: Float[np.ndarray, "F"] | None = None

    @property
    def lengths(self) -> Float[np.ndarray, "F"]:
        largest = np.abs(self.vectors).max(axis=1)
        return largest * np.linalg.norm(self.scaled, axis=1)

    @property
    def scaled(self) -> Float[np.ndarray, "F 3"]:
        """The vectors over their largest components, whose squares neither over- nor underflow."""
        largest = np.abs(self.vectors).max(axis=1, keepdims=True)
        return np.divide(self.vectors, largest, out=np.zeros_like(self.vectors), where=largest > 0)

    @property
    def unit(self) -> bool:
        return bool((np.abs(self.lengths - 1) <= UNIT).all())

    @property
    def in_front(self) -> bool:
        return bool((self.vectors[:, 2] > 0).all())


def read_lights(
    path: Path | str, count: int, names: Sequence[str] = (), *, positions: bool = False
) -> Lights:
    """Read light directions: x y z a line, one line for each image in its order.

    Directions point from the object to the light, x right, y up, z towards the camera, and are
    brought to unit length: how strong a light is a fourth number of its line says. `read_table`
    says what the text may look like; a `.npy` file holds the same numbers.

    Lines may start with a running number, or with the names of photographs (`.lp`), which then
    say which light is whose. The table may be turned, with a column for each image. Which it is
    the shape tells, and where it does not, the directions' unit length; or a first line with the
    names of the columns: `x y z`, `x y z intensity`, or `azimuth elevation`, in degrees as
    `conventions.light_direction` has them.

    Parameters
    ----------
    path
        The file.
    count
        How many images there are.
    names
        Their file names, to find them in a file that names them.
    positions
        Whether x y z are places of lamps, whose lengths mean something.

    Returns
    -------
    Lights
        One for each image, in their order.

    Raises
    ------
    FileError
        If the file is no such table, the number of lines is not `count`, it can be understood in
        several ways, a direction is zero, an intensity is not positive, or no light is in front
        of the object.
    """
    table = read_table(path)
    notes = []
    reading = _named(path, table, count) if table.columns else _likeliest(path, table, count)
    if positions and table.columns is not None and _AXES[0] not in table.columns:
        raise FileError(f"{path}: holds angles, but positions of lamps are needed: x y z")
    vectors, intensities = reading.scaled, reading.intensities
    lengths = reading.lengths
    if not lengths.all():
        raise FileError(f"{path}: holds a direction of length zero; give x y z to every light")
    if (vectors[:, 2] <= 0).all():
        raise FileError(
            f"{path}: puts every light behind the object (z <= 0), but directions go from the "
            "object to the light, x right, y up, z towards the camera; negate z, or all three "
            "numbers if they go from the light to the object"
        )
    if intensities is not None and not (intensities > 0).all():
        raise FileError(f"{path}: holds an intensity that is not positive; leave out that image")
    if not positions and np.ptp(lengths) > UNEQUAL * lengths.max():
        notes.append(
            f"{Path(path).name}: directions have lengths of {lengths.min():.3g} to "
            f"{lengths.max():.3g}, which are not used; give intensities as a fourth number, or say "
            "that they are positions (--near-lamps)"
        )
    if positions and reading.unit:
        notes.append(
            f"{Path(path).name}: all lamps are taken to be one object's width away; if these are "
            "directions only, leave out --near-lamps"
        )
    if reading.how:
        notes.append(f"{Path(path).name}: {reading.how}")
    directions = vectors / np.linalg.norm(vectors, axis=1, keepdims=True)
    if table.rows is not None and names:
        order = _order(path, table.rows, names)
        directions = directions[order]
        lengths = lengths[order]
        intensities = None if intensities is None else intensities[order]
    return Lights(directions, lengths, intensities, tuple(notes))


def _named(path: Path | str, table: Table, count: int) -> _Reading:
    """Return what the names of the columns say."""
    assert table.columns is not None
    place = {name: n for n, name in enumerate(table.columns)}
    numbers = table.numbers
    if len(place) != numbers.shape[1] or len(numbers) != count:
        raise _unfit(path, table, count)
    strength = numbers[:, place[_INTENSITY]] if _INTENSITY in place else None
    if all(name in place for name in _AXES):
        return _Reading("", numbers[:, [place[name] for name in _AXES]], strength)
    if all(name in place for name in _ANGLES):
        angles = numbers[:, [place[name] for name in _ANGLES]]
        if (np.abs(angles[:, 1]) > 90).any():
            raise FileError(f"{path}: an elevation lies in [-90, 90] degrees")
        return _Reading("", np.array([light_direction(*pair) for pair in angles]), strength)
    raise FileError(
        f"{path}: names the columns {excerpt(' '.join(table.columns))}; x y z, or azimuth "
        "elevation, and intensity are understood"
    )


def _likeliest(path: Path | str, table: Table, count: int) -> _Reading:
    """Return the one reading with unit vectors, or the only one that there is."""
    numbers = table.numbers
    readings = _readings(numbers, count, "")
    if table.rows is None:
        turned = "a column is taken for each image" if len(set(numbers.shape)) == 1 else ""
        readings += _readings(numbers.T, count, turned)
    if not readings:
        raise _unfit(path, table, count)
    # Only where lengths leave a choice does it count that lights are in front of the object.
    for wanted in ([r for r in readings if r.unit], [r for r in readings if r.unit and r.in_front]):
        if len(wanted) == 1:
            return wanted[0]
    same = np.allclose(readings[0].vectors, readings[-1].vectors)
    if len(readings) == 1 or (len(readings) == 2 and same):
        return readings[0]
    raise FileError(
        f"{path}: can be understood in {len(readings)} ways; write the line x y z (or x y z "
        "intensity) above its numbers, one line for each image and without running numbers"
    )


def _readings(numbers: Float[np.ndarray, "n m"], count: int, how: str) -> list[_Reading]:
    """Return how the rows of a table can be taken for lights."""
    if len(numbers) != count or numbers.shape[1] not in (3, 4):
        return []
    found = [_Reading(how, numbers[:, :3], numbers[:, 3] if numbers.shape[1] == 4 else None)]
    first = numbers[:, 0]
    order = np.argsort(first, kind="stable")
    if numbers.shape[1] == 4 and any(
        np.array_equal(first[order], np.arange(count) + start) for start in (0, 1)
    ):
        parts = (how, "its first numbers are taken as running numbers")
        found.append(_Reading("; ".join(part for part in parts if part), numbers[order, 1:]))
    return found


def _order(path: Path | str, rows: Sequence[str], names: Sequence[str]) -> list[int]:
    """Return the row of every image; endings are left out, as photographs get converted."""
    # Programs of any system write these names.
    stems = [PurePosixPath(row.replace("\\", "/")).stem.lower() for row in rows]
    if len(set(stems)) < len(stems):
        raise FileError(f"{path}: names a photograph twice")
    order = []
    for name in names:
        stem = PurePosixPath(name).stem.lower()
        if stem not in stems:
            raise FileError(f"{path}: does not name the photograph {excerpt(name)}")
        order.append(stems.index(stem))
    return order


def _unfit(path: Path | str, table: Table, count: int) -> FileError:
    rows, columns = table.numbers.shape
    return FileError(
        f"{path}: holds {rows} lines of {columns} numbers, but {count} images need a line each: "
        "x y z, and the intensity if it is known; angles need the line azimuth elevation above "
        "them"
    )
