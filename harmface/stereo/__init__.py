"""Photometric stereo: surface and albedo from photographs under known or unknown light."""

from harmface.stereo.chrome_ball import MirrorSphere, directions_from_mirror_sphere
from harmface.stereo.evaluation import (
    AngularError,
    angular_errors,
    summary,
    without_bas_relief,
    without_convexity,
    without_linear_map,
    without_lorentz,
    without_rotation,
)
from harmface.stereo.factorization import Factorization, factorize
from harmface.stereo.gauge import Belief
from harmface.stereo.handedness import seems_upside_down
from harmface.stereo.hayakawa import point_source_structure
from harmface.stereo.known_lights import normals_from_coefficients, normals_from_directions
from harmface.stereo.lorentz import NullCone, fit_null_cone, lorentz_deviation
from harmface.stereo.object_mask import object_mask
from harmface.stereo.photometric import photometric_stereo
from harmface.stereo.result import StereoReport, StereoResult
from harmface.stereo.robust_factorization import RobustFactorization, factorize_robustly
from harmface.stereo.stack import ImageStack, image_stack

__all__ = [
    "AngularError",
    "Belief",
    "Factorization",
    "ImageStack",
    "MirrorSphere",
    "NullCone",
    "RobustFactorization",
    "StereoReport",
    "StereoResult",
    "angular_errors",
    "directions_from_mirror_sphere",
    "factorize",
    "factorize_robustly",
    "fit_null_cone",
    "image_stack",
    "lorentz_deviation",
    "normals_from_coefficients",
    "normals_from_directions",
    "object_mask",
    "photometric_stereo",
    "point_source_structure",
    "seems_upside_down",
    "summary",
    "without_bas_relief",
    "without_convexity",
    "without_linear_map",
    "without_lorentz",
    "without_rotation",
]
