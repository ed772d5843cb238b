"""Mathematics on the unit sphere: directions, quadrature, harmonics, transforms, rotation."""

from harmface.sphere.complex_harmonics import complex_harmonics, complex_to_real, real_to_complex
from harmface.sphere.directions import (
    fibonacci_directions,
    random_directions,
    stratified_directions,
)
from harmface.sphere.frames import frames_facing, in_frames, mixed_functions
from harmface.sphere.gradients import derivative_matrices, harmonic_gradients
from harmface.sphere.harmonics import real_harmonics
from harmface.sphere.products import (
    gaunt_tensor,
    multiplication_matrix,
    product,
    triple_product,
)
from harmface.sphere.quadrature import Quadrature, gauss_legendre, lebedev
from harmface.sphere.rotation import rotate, rotate_zonal, rotation_matrices
from harmface.sphere.transforms import energy_per_degree, project, project_function, synthesize

__all__ = [
    "Quadrature",
    "complex_harmonics",
    "complex_to_real",
    "derivative_matrices",
    "energy_per_degree",
    "fibonacci_directions",
    "frames_facing",
    "gaunt_tensor",
    "gauss_legendre",
    "harmonic_gradients",
    "in_frames",
    "lebedev",
    "mixed_functions",
    "multiplication_matrix",
    "product",
    "project",
    "project_function",
    "random_directions",
    "real_harmonics",
    "real_to_complex",
    "rotate",
    "rotate_zonal",
    "rotation_matrices",
    "stratified_directions",
    "synthesize",
    "triple_product",
]
