"""Photometric stereo: surface and albedo from photographs under known or unknown light."""

from harmface.stereo.evaluation import (
    AngularError,
    angular_errors,
    summary,
    without_convexity,
    without_linear_map,
    without_lorentz,
    without_rotation,
)
from harmface.stereo.factorization import Factorization, factorize
from harmface.stereo.first_order import FirstOrder, first_order
from harmface.stereo.handedness import seems_upside_down
from harmface.stereo.hayakawa import point_source_structure
from harmface.stereo.known_lights import normals_from_coefficients, normals_from_directions
from harmface.stereo.lorentz import NullCone, fit_null_cone, lorentz_deviation
from harmface.stereo.photometric import photometric_stereo
from harmface.stereo.refinement import Refined, refine
from harmface.stereo.result import StereoReport, StereoResult
from harmface.stereo.robust_factorization import RobustFactorization, factorize_robustly
from harmface.stereo.second_order import SecondOrder, second_order
from harmface.stereo.stack import ImageStack, image_stack

__all__ = [
    "AngularError",
    "Factorization",
    "FirstOrder",
    "ImageStack",
    "NullCone",
    "Refined",
    "RobustFactorization",
    "SecondOrder",
    "StereoReport",
    "StereoResult",
    "angular_errors",
    "factorize",
    "factorize_robustly",
    "first_order",
    "fit_null_cone",
    "image_stack",
    "lorentz_deviation",
    "normals_from_coefficients",
    "normals_from_directions",
    "photometric_stereo",
    "point_source_structure",
    "refine",
    "second_order",
    "seems_upside_down",
    "summary",
    "without_convexity",
    "without_linear_map",
    "without_lorentz",
    "without_rotation",
]
