"""How a surface answers to light: Lambert's transfer function and its spectrum."""

from harmface.reflectance.lambert import (
    clamped_cosine_coefficients,
    lambda_normalization,
    lambert_coefficients,
    lambert_per_coefficient,
)
from harmface.reflectance.truncation import energy_by_degree, mean_accuracy_bound, truncation_error

__all__ = [
    "clamped_cosine_coefficients",
    "energy_by_degree",
    "lambda_normalization",
    "lambert_coefficients",
    "lambert_per_coefficient",
    "mean_accuracy_bound",
    "truncation_error",
]
