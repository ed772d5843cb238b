"""A population of parametric heads: shape, albedo, identity."""

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
