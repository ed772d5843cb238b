"""Which experiment measures which claim."""

from harmface.reproduce import (
    irradiance,
    lambert,
    near_field,
    pca,
    recognition,
    stereo,
    subspaces,
    transfer,
)
from harmface.reproduce.experiment import Experiment

EXPERIMENTS: dict[str, Experiment] = {
    "lambert-coefficients": lambert.coefficients,
    "lambert-decay": lambert.decay,
    "energy-by-degree": lambert.energy,
    "worst-pixel-error": lambert.worst_pixel,
    "non-negative-bound": lambert.non_negative_bound,
    "irradiance-matrix": irradiance.three_forms,
    "irradiance-error-natural": irradiance.natural_errors,
    "prefilter-speed": irradiance.prefilter_speed,
    "linear-3d-no-shadows": subspaces.linear_3d,
    "subspace-4d-9d-energy": subspaces.subspace_energy,
    "pca-sphere": pca.whole_sphere,
    "pca-hemisphere": pca.hemisphere,
    "pca-face": pca.face,
    "pca-face-cumulative": pca.face_cumulative,
    "pca-face-empirical": pca.face_empirical,
    "pca-modes-agree": pca.modes_agree,
    "recognition-small-set": recognition.small_set,
    "recognition-light-grid": recognition.light_grid,
    "stereo-rank": stereo.rank,
    "stereo-lorentz": stereo.lorentz,
    "stereo-normals": stereo.normals,
    "transfer-bowl": transfer.bowl,
    "transfer-convex": transfer.convex,
    "transfer-subspaces": transfer.subspaces,
    "near-field-gradient": near_field.gradient,
    "near-field-gain": near_field.gain,
    "near-field-cost": near_field.cost,
    "near-light-energy": near_field.near_light_energy,
}
