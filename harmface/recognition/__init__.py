"""Who is it: subspaces of a subject's images under all lights, and distances to them."""

from harmface.recognition.classifier import HarmonicSubspaceClassifier
from harmface.recognition.gallery import Gallery, enroll, subject_images
from harmface.recognition.subspace import orthonormal_basis, subspace_distances

__all__ = [
    "Gallery",
    "HarmonicSubspaceClassifier",
    "enroll",
    "orthonormal_basis",
    "subject_images",
    "subspace_distances",
]
