"""Other people's recognisers, on the same probes as ours: extras that must be installed.

References
----------
.. [K09] King, Dlib-ml: A Machine Learning Toolkit, JMLR 2009.
"""

import importlib
from functools import cache
from typing import Any

import cv2
import numpy as np
from jaxtyping import Float

from harmface.errors import ArgumentError
from harmface.recognition.distance import Model
from harmface.recognition.nearest import NearestImageDistance

MARGIN = 0.25
"""Of the longer side, added around a crop: the network has seen whole heads."""

ROWS = 192
"""Rows that smaller crops are enlarged to, for the points to be found."""

BRIGHT = 99.5
"""Percentile that becomes white."""


class DlibDistance(NearestImageDistance):
    """The distance of the 128 numbers of dlib's network for faces [K09]_, of the extra `peers`.

    The face is where the whole crop is: five points are sought there, and no detector may fail.
    """

    def features(
        self, model: Model, images: Float[np.ndarray, "n H W"]
    ) -> Float[np.ndarray, "n d"]:
        """Return the network's answers.

        Raises
        ------
        ArgumentError
            If the extra is not installed.
        """
        return np.stack([_embedding(image) for image in images])


@cache
def _network() -> tuple[Any, Any, Any]:
    """Return dlib, its five-point predictor and its network."""
    try:
        dlib = importlib.import_module("dlib")
        models = importlib.import_module("face_recognition_models")
    except ModuleNotFoundError:
        raise ArgumentError(
            "method dlib must have its network: pip install 'harmface[peers]'"
        ) from None
    return (
        dlib,
        dlib.shape_predictor(models.pose_predictor_five_point_model_location()),
        dlib.face_recognition_model_v1(models.face_recognition_model_location()),
    )


def _embedding(image: Float[np.ndarray, "H W"]) -> Float[np.ndarray, "d"]:
    dlib, predictor, network = _network()
    bright = max(float(np.percentile(image, BRIGHT)), np.finfo(np.float32).tiny)
    codes = np.rint(255 * np.clip(image / bright, 0, 1)).astype(np.uint8)
    scale = max(1.0, ROWS / codes.shape[0])
    codes = cv2.resize(codes, None, fx=scale, fy=scale, interpolation=cv2.INTER_CUBIC)
    by, (rows, columns) = round(MARGIN * max(codes.shape)), codes.shape
    padded = cv2.copyMakeBorder(codes, by, by, by, by, cv2.BORDER_REPLICATE)
    pixels = cv2.cvtColor(padded, cv2.COLOR_GRAY2RGB)
    points = predictor(pixels, dlib.rectangle(by, by, by + columns, by + rows))
    return np.array(network.compute_face_descriptor(pixels, points))
