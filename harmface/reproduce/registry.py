"""Which experiment measures which claim."""

from harmface.reproduce import inverse, irradiance, lambert, pca, recognition, stereo, subspaces
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
    "inverse-light-conditioning": inverse.conditioning,
    "inverse-light-odd-degrees": inverse.odd_degrees,
    "inverse-light-faces": inverse.faces,
}
