"""Who is it: subspaces of a subject's images under all lights, and distances to them."""

from harmface.recognition.answers import (
    Rejection,
    estimated_light,
    likelihood_posteriors,
    margins,
    posteriors,
    rejection,
)
from harmface.recognition.cast_shadows import shadowed_harmonic_images
from harmface.recognition.classifier import HarmonicSubspaceClassifier
from harmface.recognition.cone_classifier import IlluminationConeClassifier
from harmface.recognition.gallery import Gallery, enroll, subject_images, subject_photographs
from harmface.recognition.illumination_cone import (
    cone_distances,
    extreme_lights,
    lamp_images,
    low_dimensional_cone,
    scaled_normals,
)
from harmface.recognition.local_classifier import LocalSubspaceClassifier
from harmface.recognition.local_subspace import (
    Windows,
    local_basis,
    local_distances,
    log_intensity,
)
from harmface.recognition.nine_points import greedy_lights, nearest_lights, nine_points
from harmface.recognition.noise import CameraNoise, Likelihoods, likelihoods
from harmface.recognition.non_negative import non_negative_distances, non_negative_light
from harmface.recognition.non_negative_4d import non_negative_distances_4d
from harmface.recognition.robust import pixel_blocks, robust_distances
from harmface.recognition.robust_classifier import RobustSubspaceClassifier
from harmface.recognition.specular import (
    extended_bases,
    phong_coefficients,
    specular_images,
    subject_highlights,
)
from harmface.recognition.subspace import orthonormal_basis, subspace_distances

__all__ = [
    "CameraNoise",
    "Gallery",
    "HarmonicSubspaceClassifier",
    "IlluminationConeClassifier",
    "Likelihoods",
    "LocalSubspaceClassifier",
    "Rejection",
    "RobustSubspaceClassifier",
    "Windows",
    "cone_distances",
    "enroll",
    "estimated_light",
    "extended_bases",
    "extreme_lights",
    "greedy_lights",
    "lamp_images",
    "likelihood_posteriors",
    "likelihoods",
    "local_basis",
    "local_distances",
    "log_intensity",
    "low_dimensional_cone",
    "margins",
    "nearest_lights",
    "nine_points",
    "non_negative_distances",
    "non_negative_distances_4d",
    "non_negative_light",
    "orthonormal_basis",
    "phong_coefficients",
    "pixel_blocks",
    "posteriors",
    "rejection",
    "robust_distances",
    "scaled_normals",
    "shadowed_harmonic_images",
    "specular_images",
    "subject_highlights",
    "subject_images",
    "subject_photographs",
    "subspace_distances",
]
