"""How surfaces answer to light: materials, and their spectra."""

from harmface.reflectance.lambert import (
    clamped_cosine_coefficients,
    lambda_normalization,
    lambert_coefficients,
    lambert_per_coefficient,
)
from harmface.reflectance.material import Material
from harmface.reflectance.matte import Lambert, OrenNayar
from harmface.reflectance.microfacet import GGX, Beckmann, Microfacet, TorranceSparrow
from harmface.reflectance.mirror import Mirror
from harmface.reflectance.mixture import Mixture
from harmface.reflectance.names import material_named
from harmface.reflectance.phong import Blinn, Phong
from harmface.reflectance.tabulated import Tabulated
from harmface.reflectance.truncation import (
    energy_by_degree,
    lobe_degree,
    mean_accuracy_bound,
    truncation_error,
)

__all__ = [
    "GGX",
    "Beckmann",
    "Blinn",
    "Lambert",
    "Material",
    "Microfacet",
    "Mirror",
    "Mixture",
    "OrenNayar",
    "Phong",
    "Tabulated",
    "TorranceSparrow",
    "clamped_cosine_coefficients",
    "energy_by_degree",
    "lambda_normalization",
    "lambert_coefficients",
    "lambert_per_coefficient",
    "lobe_degree",
    "material_named",
    "mean_accuracy_bound",
    "truncation_error",
]
