"""Images from geometry and light: the harmonic model, and the oracle without harmonics."""

from harmface.rendering.cast_shadows import shadowed_harmonic_images
from harmface.rendering.glossy_maps import reflection_map
from harmface.rendering.glossy_transfer import (
    ClusteredTransfer,
    clustered_pca,
    glossy_radiance,
    glossy_transfer,
)
from harmface.rendering.harmonic_images import harmonic_images, outgoing_radiance, relight
from harmface.rendering.irradiance import (
    harmonic_irradiance,
    irradiance_error,
    irradiance_map,
    irradiance_matrix,
    matrix_irradiance,
    polynomial_irradiance,
)
from harmface.rendering.precomputed_transfer import Transfer, transfer, visibility_coefficients
from harmface.rendering.reference import (
    box_average,
    clamped_cosines,
    irradiance,
    mirrored,
    reflected,
    render,
    vertex_irradiance,
)
from harmface.rendering.reflected_field import ReflectedField
from harmface.rendering.scene import Scene, Surface, probes, ray_cast_probes, sampled_light

__all__ = [
    "ClusteredTransfer",
    "ReflectedField",
    "Scene",
    "Surface",
    "Transfer",
    "box_average",
    "clamped_cosines",
    "clustered_pca",
    "glossy_radiance",
    "glossy_transfer",
    "harmonic_images",
    "harmonic_irradiance",
    "irradiance",
    "irradiance_error",
    "irradiance_map",
    "irradiance_matrix",
    "matrix_irradiance",
    "mirrored",
    "outgoing_radiance",
    "polynomial_irradiance",
    "probes",
    "ray_cast_probes",
    "reflected",
    "reflection_map",
    "relight",
    "render",
    "sampled_light",
    "shadowed_harmonic_images",
    "transfer",
    "vertex_irradiance",
    "visibility_coefficients",
]
