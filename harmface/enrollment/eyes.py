"""Eyes found in photographs by detectors that other people trained; each runs offline."""

import importlib
from collections.abc import Callable
from pathlib import Path
from typing import Any

import cv2
import numpy as np
from jaxtyping import Float, UInt8

from harmface.errors import ArgumentError, FileError

EyeFinder = Callable[[Float[np.ndarray, "H W"]], Float[np.ndarray, "2 2"] | None]
"""From the luminance of a photograph to the places (x, y) of the eyes of the largest face, the left
one in the picture first; None if no face was found. Centres of pixels lie at half-integers."""

MARGIN = 0.25
"""Of the longer side, added around a photograph: a face may fill it."""

LARGEST = 800
"""Pixels of the longer side of what is searched; a face of a tenth of it is still found."""

SCORE = 0.6
"""Least confidence of a face of `FaceDetectorYN`."""


def dlib_eyes() -> EyeFinder:
    """Return dlib's frontal detector and its five points, of the `align` extra.

    Returns
    -------
    EyeFinder
        A function of the luminance, (H, W), of a photograph.

    Raises
    ------
    ArgumentError
        If the extra is not installed.
    """
    try:
        dlib = importlib.import_module("dlib")
        models = importlib.import_module("face_recognition_models")
    except ModuleNotFoundError:
        raise ArgumentError(
            "faces must be found by a detector, but none is installed: pip install "
            "'harmface[align]', give an ONNX file for OpenCV's FaceDetectorYN (--detector), or the "
            "eyes by hand (--points)"
        ) from None
    detector = dlib.get_frontal_face_detector()
    predictor = dlib.shape_predictor(models.pose_predictor_five_point_model_location())

    def search(codes: UInt8[np.ndarray, "H W"]) -> Float[np.ndarray, "2 2"] | None:
        found = detector(codes, 0)
        if not len(found):
            return None
        largest = max(found, key=lambda box: box.area())
        corners = np.array([(p.x, p.y) for p in predictor(codes, largest).parts()], float)
        # Two corners of each eye, those of the one on the right in the picture first.
        return np.stack([corners[2:4].mean(axis=0), corners[:2].mean(axis=0)]) + 0.5

    return _searching(search)


def yunet_eyes(model: Path) -> EyeFinder:
    """Return OpenCV's `FaceDetectorYN` with the user's file of its network.

    Parameters
    ----------
    model
        An ONNX file.

    Returns
    -------
    EyeFinder
        A function of the luminance, (H, W), of a photograph.

    Raises
    ------
    FileError
        If the file is missing or OpenCV cannot read it.
    """
    if not model.is_file():
        raise FileError(f"{model}: is no file; give the ONNX file of a YuNet face detector")
    try:
        detector: Any = cv2.FaceDetectorYN.create(str(model), "", (320, 320), SCORE)
    except cv2.error as error:
        reason = str(error).splitlines()[0][:100]
        raise FileError(
            f"{model}: is no face detector that OpenCV can read ({reason}); give the ONNX file of "
            "a YuNet"
        ) from None

    def search(codes: UInt8[np.ndarray, "H W"]) -> Float[np.ndarray, "2 2"] | None:
        detector.setInputSize(codes.shape[::-1])
        _, found = detector.detect(cv2.cvtColor(codes, cv2.COLOR_GRAY2BGR))
        if found is None:
            return None
        largest = found[np.argmax(found[:, 2] * found[:, 3])].astype(float)
        # After the box come the eyes, the one on the left in the picture first.
        return largest[4:8].reshape(2, 2) + 0.5

    return _searching(search)


def _searching(
    search: Callable[[UInt8[np.ndarray, "H W"]], Float[np.ndarray, "2 2"] | None],
) -> EyeFinder:
    """Return a finder that shows a detector an evened photograph with room around it."""

    def find(image: Float[np.ndarray, "H W"]) -> Float[np.ndarray, "2 2"] | None:
        by = round(MARGIN * max(image.shape))
        bright = max(float(np.percentile(image, 99.5)), np.finfo(np.float32).tiny)
        codes = np.rint(255 * np.clip(image / bright, 0, 1)).astype(np.uint8)
        padded = cv2.copyMakeBorder(codes, by, by, by, by, cv2.BORDER_REPLICATE)
        scale = min(1.0, LARGEST / max(padded.shape))
        small = cv2.resize(padded, None, fx=scale, fy=scale, interpolation=cv2.INTER_AREA)
        found = search(cv2.equalizeHist(small))
        return None if found is None else found / scale - by

    return find
