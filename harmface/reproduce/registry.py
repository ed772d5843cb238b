"""Which experiment measures which claim."""

from harmface.reproduce import lambert, recognition, subspaces
from harmface.reproduce.experiment import Experiment

EXPERIMENTS: dict[str, Experiment] = {
    "lambert-coefficients": lambert.coefficients,
    "lambert-decay": lambert.decay,
    "energy-by-degree": lambert.energy,
    "worst-pixel-error": lambert.worst_pixel,
    "non-negative-bound": lambert.non_negative_bound,
    "linear-3d-no-shadows": subspaces.linear_3d,
    "subspace-4d-9d-energy": subspaces.subspace_energy,
    "recognition-small-set": recognition.small_set,
}
