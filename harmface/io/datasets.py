"""Data sets of rendered images, read lazily."""

import json
from dataclasses import dataclass
from pathlib import Path, PurePosixPath
from typing import Any

import numpy as np
from jaxtyping import Bool, Float

from harmface.errors import ArgumentError, FileError
from harmface.io.files import read_bytes
from harmface.io.images import read_image

MANIFEST, VERSION = "manifest.json", 1


@dataclass(frozen=True, eq=False)
class Dataset:
    """A folder of labelled images, see `harmface synth dataset`; pixels are read when asked for.

    Parameters
    ----------
    folder
        Where it is.
    manifest
        Everything that is known of every image, as `manifest.json` has it.
    """

    folder: Path
    manifest: dict[str, Any]

    @property
    def subjects(self) -> list[str]:
        """Names of the subjects."""
        return [str(subject["name"]) for subject in self.manifest["subjects"]]

    def images(self, subject: str) -> Float[np.ndarray, "F H W"]:
        """Return a subject's images, linear, in [0, 1]."""
        record = self._record(subject)
        return np.stack(
            [read_image(self.folder / subject / image["file"]) for image in record["images"]]
        )

    def mask(self, subject: str) -> Bool[np.ndarray, "H W"]:
        """Return where the subject covers a pixel."""
        self._record(subject)
        return read_image(self.folder / subject / "mask.png") > 0.5

    def lights(self, subject: str) -> tuple[Float[np.ndarray, "J 3"], Float[np.ndarray, "F J"]]:
        """Return the directions of the lights, and the irradiance of each in each image."""
        record = self._record(subject)
        directions = np.array(record["directions"], dtype=np.float64)
        irradiances = np.zeros((len(record["images"]), len(directions)))
        for row, image in zip(irradiances, record["images"], strict=True):
            row[image["irradiances"]["direction"]] = image["irradiances"]["value"]
        return directions, irradiances

    def _record(self, subject: str) -> dict[str, Any]:
        for record in self.manifest["subjects"]:
            if record["name"] == subject:
                return dict(record)
        raise ArgumentError(f"no subject is called {subject!r}; see `subjects`")


def read_dataset(folder: Path | str) -> Dataset:
    """Open a data set that `harmface synth dataset` made.

    Raises
    ------
    FileError
        If the folder holds no manifest, or one that is broken, of another version, or that names
        files outside the folder.
    """
    folder = Path(folder)
    path = folder / MANIFEST
    try:
        manifest = json.loads(read_bytes(path))
        found = manifest["format"], manifest["version"]
        names = [
            (record["name"], image["file"])
            for record in manifest["subjects"]
            for image in record["images"]
        ]
    except (KeyError, TypeError, ValueError, RecursionError) as error:
        if isinstance(error, FileError):
            raise
        raise FileError(f"{path}: is no manifest of a data set ({error})") from None
    if found != ("harmface-dataset", VERSION):
        raise FileError(f"{path}: is {found[0]} version {found[1]}, version {VERSION} is needed")
    for name in {part for pair in names for part in pair}:
        if not isinstance(name, str) or PurePosixPath(name).name != name or name in ("", ".."):
            raise FileError(f"{path}: names {name!r}, which is no plain file name")
    return Dataset(folder, manifest)
