"""Histograms of local binary patterns, by OpenCV."""

import cv2
import numpy as np
from jaxtyping import Float

from harmface.errors import ArgumentError
from harmface.recognition.distance import Model
from harmface.recognition.nearest import NearestImageDistance


class LbphDistance(NearestImageDistance):
    """The distance of the histograms of local binary patterns (OpenCV's LBPH)."""

    def features(
        self, model: Model, images: Float[np.ndarray, "n H W"]
    ) -> Float[np.ndarray, "n d"]:
        """Return the histograms of images, each stretched to 8 bits."""
        rows = images.reshape(len(images), -1)
        low, span = rows.min(axis=1, keepdims=True), np.ptp(rows, axis=1, keepdims=True)
        scaled = np.divide(rows - low, span, out=np.zeros_like(rows), where=span > 0)
        codes = np.rint(255 * scaled).astype(np.uint8).reshape(images.shape)
        recognizer = cv2.face.LBPHFaceRecognizer.create()
        recognizer.train(list(codes), np.arange(len(codes), dtype=np.int32))
        return np.concatenate(recognizer.getHistograms())

    def between(
        self, probes: Float[np.ndarray, "n d"], gallery: Float[np.ndarray, "g d"]
    ) -> Float[np.ndarray, "n g"]:
        """Return the chi-square distances that OpenCV's recogniser ranks by."""
        if probes.shape[1] != gallery.shape[1]:
            raise ArgumentError(
                f"histograms must have {gallery.shape[1]} bins, got {probes.shape[1]}"
            )
        return np.array(
            [[cv2.compareHist(a, b, cv2.HISTCMP_CHISQR_ALT) for b in gallery] for a in probes]
        )
