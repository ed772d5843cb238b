"""Light from photographs of known surfaces, and photographs in other light."""

from harmface.inverse.albedo import estimate_light_and_albedo
from harmface.inverse.conditioning import singular_values
from harmface.inverse.estimate import estimate_light
from harmface.inverse.factorization import (
    Consistency,
    Factorization,
    consistent_light,
    factorize,
)
from harmface.inverse.pose import camera_from_mask, pose_from_landmarks
from harmface.inverse.prior import LightPrior
from harmface.inverse.reflectance import (
    MaterialFit,
    ReflectanceEstimate,
    estimate_reflectance,
    field_from_samples,
    fit_material,
    reflected_field,
)
from harmface.inverse.relighting import relight_photograph
from harmface.inverse.result import LightEstimate
from harmface.inverse.surface import PhotographedSurface

__all__ = [
    "Consistency",
    "Factorization",
    "LightEstimate",
    "LightPrior",
    "MaterialFit",
    "PhotographedSurface",
    "ReflectanceEstimate",
    "camera_from_mask",
    "consistent_light",
    "estimate_light",
    "estimate_light_and_albedo",
    "estimate_reflectance",
    "factorize",
    "field_from_samples",
    "fit_material",
    "pose_from_landmarks",
    "reflected_field",
    "relight_photograph",
    "singular_values",
]
