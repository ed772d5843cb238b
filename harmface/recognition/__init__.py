"""Who is it: subspaces of a subject's images under all lights, and distances to them."""

from harmface.recognition.answers import (
    Rejection,
    estimated_light,
    margins,
    posteriors,
    rejection,
)
from harmface.recognition.cast_shadows import shadowed_harmonic_images
from harmface.recognition.classifier import HarmonicSubspaceClassifier
from harmface.recognition.gallery import Gallery, enroll, subject_images, subject_photographs
from harmface.recognition.local_classifier import LocalSubspaceClassifier
from harmface.recognition.local_subspace import (
    Windows,
    local_basis,
    local_distances,
    log_intensity,
)
from harmface.recognition.nine_points import greedy_lights, nearest_lights, nine_points
from harmface.recognition.non_negative import non_negative_distances, non_negative_light
from harmface.recognition.non_negative_4d import non_negative_distances_4d
from harmface.recognition.subspace import orthonormal_basis, subspace_distances

__all__ = [
    "Gallery",
    "HarmonicSubspaceClassifier",
    "LocalSubspaceClassifier",
    "Rejection",
    "Windows",
    "enroll",
    "estimated_light",
    "greedy_lights",
    "local_basis",
    "local_distances",
    "log_intensity",
    "margins",
    "nearest_lights",
    "nine_points",
    "non_negative_distances",
    "non_negative_distances_4d",
    "non_negative_light",
    "orthonormal_basis",
    "posteriors",
    "rejection",
    "shadowed_harmonic_images",
    "subject_images",
    "subject_photographs",
    "subspace_distances",
]
