"""Data sets of rendered images, read lazily."""

import json
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from jaxtyping import Bool, Float

from harmface.errors import ArgumentError, FileError
from harmface.io.files import MAX_TEXT, PARSE_ERRORS, excerpt, is_file_name, read_bytes
from harmface.io.folders import MANIFEST
from harmface.io.images import read_image

VERSION = 1


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
        """Return a subject's images, linear, in [0, 1].

        Parameters
        ----------
        subject
            Name of the subject.

        Returns
        -------
        numpy.ndarray
            Shape (F, H, W), float64.

        Raises
        ------
        FileError
            If there is no such subject, or an image is missing, broken or of another size.
        """
        record = self._record(subject)
        found = [read_image(self.folder / subject / image["file"]) for image in record["images"]]
        shapes = {image.shape for image in found}
        if len(shapes) != 1:
            raise FileError(f"{self.folder / subject}: needs images of one size, got {shapes}")
        return np.stack(found)

    def mask(self, subject: str) -> Bool[np.ndarray, "H W"]:
        """Return where the subject covers a pixel.

        Parameters
        ----------
        subject
            Name of the subject.

        Returns
        -------
        numpy.ndarray
            Shape (H, W), bool.
        """
        self._record(subject)
        return read_image(self.folder / subject / "mask.png") > 0.5

    def lights(self, subject: str) -> tuple[Float[np.ndarray, "J 3"], Float[np.ndarray, "F J"]]:
        """Return the directions of the lights, and the irradiance of each in each image.

        Parameters
        ----------
        subject
            Name of the subject.

        Returns
        -------
        tuple of numpy.ndarray
            Unit vectors to the lights, (J, 3), and irradiances at normal incidence, (F, J); both
            float64.

        Raises
        ------
        FileError
            If there is no such subject, or the manifest holds no lights of use.
        """
        record = self._record(subject)
        try:
            directions = np.array(record["directions"], dtype=np.float64).reshape(-1, 3)
            irradiances = np.zeros((len(record["images"]), len(directions)))
            for row, image in zip(irradiances, record["images"], strict=True):
                lit = np.array(image["irradiances"]["direction"], dtype=np.int64)
                if lit.size and not 0 <= lit.min() <= lit.max() < len(directions):
                    raise ValueError("an image is lit from a direction that is not listed")
                row[lit] = image["irradiances"]["value"]
        except PARSE_ERRORS as error:
            raise FileError(
                f"{self.folder / MANIFEST}: has no lights of use for {excerpt(repr(subject))} "
                f"({excerpt(error)})"
            ) from None
        return directions, irradiances

    def _record(self, subject: str) -> dict[str, Any]:
        for record in self.manifest["subjects"]:
            if record["name"] == subject:
                return dict(record)
        raise ArgumentError(f"no subject is called {subject!r}; see `subjects`")


def read_dataset(folder: Path | str, *, max_bytes: int = MAX_TEXT) -> Dataset:
    """Open a data set that `harmface synth dataset` made.

    Parameters
    ----------
    folder
        Where it is.
    max_bytes
        Largest manifest read; in memory it takes some thirty times as much.

    Returns
    -------
    Dataset
        Its manifest is read, its images are not.

    Raises
    ------
    FileError
        If the folder holds no manifest, or one that is broken, larger than `max_bytes`, of
        another version, or that names files outside the folder.
    """
    folder = Path(folder)
    path = folder / MANIFEST
    data = read_bytes(path, max_bytes)
    try:
        manifest = json.loads(data)
        found = manifest["format"], manifest["version"]
        names = [
            (record["name"], *(image["file"] for image in record["images"]))
            for record in manifest["subjects"]
        ]
    except PARSE_ERRORS as error:
        raise FileError(f"{path}: is no manifest of a data set ({excerpt(error)})") from None
    if found != ("harmface-dataset", VERSION):
        raise FileError(
            f"{path}: is {excerpt(found[0])} version {excerpt(found[1])}, version {VERSION} is "
            "needed"
        )
    for name in (name for those in names for name in those):
        if not is_file_name(name):
            raise FileError(f"{path}: names {excerpt(repr(name))}, which is no plain file name")
    return Dataset(folder, manifest)
