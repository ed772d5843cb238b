"""Principal components of lighting variability, by theory and from images."""

from harmface.pca.analytic import AnalyticPCA, analytic_pca
from harmface.pca.comparison import Comparison, bootstrap_interval, compare
from harmface.pca.distributions import (
    LightDistribution,
    cone_lights,
    directional_lights,
    environment_lights,
    front_lights,
    isotropic_lights,
    uniform_lights,
)
from harmface.pca.empirical import EmpiricalPCA, attached_shadow_pca, empirical_pca
from harmface.pca.gram import harmonic_gram
from harmface.pca.lighting_pca import LightingPCA, lighting_pca
from harmface.pca.materials import materials_spectrum
from harmface.pca.shapes import Measure, cone_gram, cylinder_gram, sphere_gram

__all__ = [
    "AnalyticPCA",
    "Comparison",
    "EmpiricalPCA",
    "LightDistribution",
    "LightingPCA",
    "Measure",
    "analytic_pca",
    "attached_shadow_pca",
    "bootstrap_interval",
    "compare",
    "cone_gram",
    "cone_lights",
    "cylinder_gram",
    "directional_lights",
    "empirical_pca",
    "environment_lights",
    "front_lights",
    "harmonic_gram",
    "isotropic_lights",
    "lighting_pca",
    "materials_spectrum",
    "sphere_gram",
    "uniform_lights",
]
