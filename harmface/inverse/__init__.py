"""Light from photographs of known surfaces, and photographs in other light."""

from harmface.inverse.albedo import estimate_light_and_albedo
from harmface.inverse.conditioning import singular_values
from harmface.inverse.estimate import estimate_light
from harmface.inverse.pose import camera_from_mask, pose_from_landmarks
from harmface.inverse.prior import LightPrior
from harmface.inverse.relighting import relight_photograph
from harmface.inverse.result import LightEstimate
from harmface.inverse.surface import PhotographedSurface

__all__ = [
    "LightEstimate",
    "LightPrior",
    "PhotographedSurface",
    "camera_from_mask",
    "estimate_light",
    "estimate_light_and_albedo",
    "pose_from_landmarks",
    "relight_photograph",
    "singular_values",
]
