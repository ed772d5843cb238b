"""Light from photographs of known surfaces, and photographs in other light."""

from harmface.inverse.conditioning import singular_values
from harmface.inverse.estimate import estimate_light
from harmface.inverse.prior import LightPrior
from harmface.inverse.result import LightEstimate

__all__ = ["LightEstimate", "LightPrior", "estimate_light", "singular_values"]
