"""Which photographs of a set are enrolled."""

from pathlib import Path

import numpy as np
from jaxtyping import Bool

from harmface.errors import ArgumentError, FileError
from harmface.io.files import MAX_TEXT, excerpt, read_bytes
from harmface.io.photo_sets import Photograph
from harmface.recognition.nine_points import nearest_lights, nine_points


def choose_gallery(photographs: list[Photograph], gallery: str) -> Bool[np.ndarray, "n"]:
    """Return which photographs make the gallery; all others are probes.

    Parameters
    ----------
    photographs
        All of them.
    gallery
        "ninepoints": of each subject those nearest to the nine points of light; "subset1": those
        under frontal light; "first:N": the first of each subject; else a text file of names, with
        or without their folders.

    Returns
    -------
    numpy.ndarray
        Shape (n,), bool.

    Raises
    ------
    ArgumentError
        If a subject is not in the gallery, or lights are needed and not known.
    FileError
        If the text file is missing or names other files.
    """
    chosen = np.zeros(len(photographs), bool)
    subjects = np.array([photograph.subject for photograph in photographs])
    if gallery in ("ninepoints", "subset1"):
        if any(photograph.light is None for photograph in photographs):
            raise ArgumentError(
                f"gallery {gallery} needs names that tell the light, as Extended Yale B has; "
                "use first:N or a list"
            )
        if gallery == "subset1":
            chosen = np.array([photograph.subset == 1 for photograph in photographs])
        else:
            chosen[_nine_points(photographs, subjects)] = True
    elif gallery.startswith("first:"):
        count = gallery.removeprefix("first:")
        if not count.isdigit() or int(count) < 1:
            raise ArgumentError(f"gallery first:N needs a whole number, got {gallery!r}")
        for subject in np.unique(subjects):
            chosen[np.flatnonzero(subjects == subject)[: int(count)]] = True
    else:
        chosen = _listed(photographs, Path(gallery))
    missing = sorted(set(subjects) - set(subjects[chosen]))
    if missing:
        raise ArgumentError(f"gallery {gallery} holds no photograph of {missing[0]}")
    return chosen


def _nine_points(photographs: list[Photograph], subjects: np.ndarray) -> np.ndarray:
    found = []
    for subject in np.unique(subjects):
        own = np.flatnonzero(subjects == subject)
        lights = np.array([photographs[i].light for i in own], dtype=np.float64)
        found.append(own[nearest_lights(lights, nine_points())])
    return np.concatenate(found)


def _listed(photographs: list[Photograph], path: Path) -> np.ndarray:
    try:
        lines = read_bytes(path, MAX_TEXT).decode("utf-8-sig").splitlines()
    except UnicodeDecodeError:
        raise FileError(f"{path}: is not a text file of photographs' names") from None
    # A name counts with any number of the folders before it.
    wanted = {line.strip().replace("\\", "/") for line in lines if line.strip()}
    found = set()
    chosen = []
    for photograph in photographs:
        whole = photograph.path.absolute()
        names = {"/".join(whole.parts[start:]) for start in range(1, len(whole.parts))}
        names |= {f"./{name}" for name in names} | {photograph.path.as_posix(), whole.as_posix()}
        found |= names & wanted
        chosen.append(bool(names & wanted))
    unknown = sorted(wanted - found)
    if unknown:
        raise FileError(f"{path}: names {excerpt(unknown[0])}, which is not among the photographs")
    return np.array(chosen)
