"""Who is it: a gallery of subjects, a distance, and one classifier made of both."""

from harmface.recognition.answers import (
    estimated_light,
    likelihood_posteriors,
    margins,
    posteriors,
)
from harmface.recognition.blocks import Ranking, merge_top, score_block, score_pairs
from harmface.recognition.classifier import SubjectClassifier
from harmface.recognition.distance import Distance
from harmface.recognition.gallery import Gallery, Photographs
from harmface.recognition.illumination_cone import (
    cone_distances,
    extreme_lights,
    lamp_images,
    low_dimensional_cone,
    scaled_normals,
)
from harmface.recognition.local_subspace import (
    LocalDistance,
    Windows,
    local_basis,
    local_distances,
    log_intensity,
)
from harmface.recognition.meshes import enroll, subject_images, subject_photographs
from harmface.recognition.methods import METHODS, best_method, distance_named
from harmface.recognition.nine_points import greedy_lights, nearest_lights, nine_points
from harmface.recognition.noise import CameraNoise, Likelihoods, likelihoods
from harmface.recognition.non_negative import non_negative_distances, non_negative_light
from harmface.recognition.non_negative_4d import non_negative_distances_4d
from harmface.recognition.robust import RobustDistance, pixel_blocks, robust_distances
from harmface.recognition.spanned import SubspaceDistance
from harmface.recognition.specular import (
    extended_bases,
    phong_coefficients,
    specular_images,
    subject_highlights,
)
from harmface.recognition.subspace import orthonormal_basis, subspace_distances
from harmface.recognition.whitened import WhitenedDistance

__all__ = [
    "METHODS",
    "CameraNoise",
    "Distance",
    "Gallery",
    "Likelihoods",
    "LocalDistance",
    "Photographs",
    "Ranking",
    "RobustDistance",
    "SubjectClassifier",
    "SubspaceDistance",
    "WhitenedDistance",
    "Windows",
    "best_method",
    "cone_distances",
    "distance_named",
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
    "merge_top",
    "nearest_lights",
    "nine_points",
    "non_negative_distances",
    "non_negative_distances_4d",
    "non_negative_light",
    "orthonormal_basis",
    "phong_coefficients",
    "pixel_blocks",
    "posteriors",
    "robust_distances",
    "scaled_normals",
    "score_block",
    "score_pairs",
    "specular_images",
    "subject_highlights",
    "subject_images",
    "subject_photographs",
    "subspace_distances",
]
