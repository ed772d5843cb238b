"""A population of parametric heads: shape, albedo, identity.

A head is a function of about seventy named parameters in physical units (`PARAMETERS`). It is
sculpted in layers on a fixed parametrisation: a loft of rings makes skull, face, jaw and neck
(`skull`); nose, mouth, eyes, ears and hair are displacements of compact support on it; asymmetry
and fine relief come last (`surface`). Colour is a function of the same places (`albedo`).

Lengths are millimetres; x points to the viewer's right, y up, z out of the face.
"""

from .parameters import PARAMETERS, Parameter
from .population import Head, build_head, head, mean_head, sample_identity

__all__ = [
    "PARAMETERS",
    "Head",
    "Parameter",
    "build_head",
    "head",
    "mean_head",
    "sample_identity",
]
