"""Gallery files: who is enrolled, and the fitted classifier that recognises them."""

from pathlib import Path
from typing import Any

import numpy as np

from harmface import checks
from harmface.errors import ArgumentError, FileError
from harmface.io.files import PARSE_ERRORS, excerpt
from harmface.io.npz import read_npz, write_npz
from harmface.recognition.classifier import SubjectClassifier, Trials
from harmface.recognition.gallery import HARMONIC, RELIT, SHADOWED, Gallery, Photographs

KIND, VERSION = "gallery", 3
MODEL, KNOWN, HELD_OUT = "model.", "known", "held_out"
"""How the arrays of a classifier begin: its model, and the two `Trials`."""

OPTIONAL = ("lights", HARMONIC, SHADOWED)


def write_gallery(path: Path | str, classifier: SubjectClassifier) -> None:
    """Write a fitted classifier, whose method is a name, and its gallery to a versioned NPZ file.

    Parameters
    ----------
    path
        The file to make or replace.
    classifier
        Fitted, with the name of a method.

    Raises
    ------
    ArgumentError
        If the method is a `Distance` and not a name, or the subjects' names are not text.
    """
    gallery = classifier.gallery_
    if not isinstance(classifier.method, str) or gallery.names.dtype.kind != "U":
        raise ArgumentError("classifier must have a method by its name and subjects that are text")
    arrays = {"photographs": gallery.photographs.images, "mask": gallery.mask}
    for name in OPTIONAL:
        if getattr(gallery, name) is not None:
            arrays[name] = getattr(gallery, name)
    attributes: dict[str, Any] = {
        "method": classifier.method,
        "subjects": gallery.photographs.subjects.tolist(),
        "aligned": gallery.aligned,
        "facts": dict(gallery.facts),
    }
    if gallery.relit is not None:
        arrays[RELIT] = gallery.relit.images
        attributes[RELIT] = gallery.relit.subjects.tolist()
    arrays |= {MODEL + name: own for name, own in classifier.model_.items()}
    for name, trials in ((KNOWN, classifier.known_), (HELD_OUT, classifier.held_out_)):
        if trials is not None:
            arrays |= {name: trials.distances, f"{name}.truth": trials.truth}
    write_npz(path, KIND, VERSION, arrays, attributes)


def read_gallery(path: Path | str) -> SubjectClassifier:
    """Read a classifier that `write_gallery` wrote; nothing is fitted again.

    Parameters
    ----------
    path
        A file of `write_gallery`, or of `harmface enroll`.

    Returns
    -------
    SubjectClassifier
        Ready to predict.

    Raises
    ------
    FileError
        If the file is missing, of another kind or version, or changed since it was written, or if
        its model cannot recognise.
    """
    arrays, attributes = read_npz(path, KIND, VERSION)
    try:
        return _classifier(arrays, attributes)
    except KeyError as error:
        raise FileError(f"{path}: is a gallery without {error}; enroll again") from None
    except PARSE_ERRORS as error:
        raise FileError(f"{path}: is no gallery of use ({excerpt(error)}); enroll again") from None


def _classifier(arrays: dict[str, np.ndarray], attributes: dict[str, Any]) -> SubjectClassifier:
    method, facts = attributes["method"], attributes["facts"]
    if not isinstance(method, str) or not isinstance(facts, dict):
        raise TypeError("method must be a name and facts a table")
    mask = arrays["mask"]
    if mask.dtype != bool or mask.ndim != 2:
        raise TypeError("mask must be a picture of true and false")
    real = {name: own for name, own in arrays.items() if name != "mask"}
    for name, own in real.items():
        if own.dtype.kind not in "fi":
            raise TypeError(f"{name} must be real numbers")
        checks.finite(name, own)
    relit = None
    if RELIT in real:
        relit = _photographs(attributes[RELIT], real[RELIT])
    gallery = Gallery(
        _photographs(attributes["subjects"], real["photographs"]),
        mask,
        relit=relit,
        aligned=attributes["aligned"] is True,
        facts=facts,
        lights=real.get("lights"),
        harmonic=real.get(HARMONIC),
        shadowed=real.get(SHADOWED),
    )
    model = {name.removeprefix(MODEL): own for name, own in real.items() if name.startswith(MODEL)}
    held_out = _trials(real, HELD_OUT) if HELD_OUT in real else None
    known = _trials(real, KNOWN)
    classifier = SubjectClassifier.restored(gallery, method, model, known, held_out)
    # A model that does not belong to the gallery cannot compare one of its photographs.
    probe = gallery.photographs.images[:1].reshape(1, -1)
    if classifier.distances(probe).shape != (1, len(gallery.names)):
        raise ValueError("its model is of other subjects")
    return classifier


def _photographs(subjects: Any, images: np.ndarray) -> Photographs:
    found = Photographs(np.array(list(map(str, subjects))), checks.non_negative("images", images))
    flat = np.ptp(images, axis=(1, 2)) == 0
    if flat.any():
        raise ValueError(f"its photograph number {flat.argmax()} has one value everywhere")
    return found


def _trials(arrays: dict[str, np.ndarray], name: str) -> Trials:
    distances, truth = arrays[name], arrays[f"{name}.truth"]
    right = distances.ndim == 2 and truth.dtype.kind == "i" and truth.shape == distances.shape[:1]
    if not right or not np.isin(truth, range(distances.shape[1])).all():
        raise ValueError(f"its {name} are not of its subjects")
    return Trials(checks.non_negative(name, distances), truth)
