"""The guard that every distance puts before its probes."""

import numpy as np
from jaxtyping import Float

from harmface import checks
from harmface.errors import ArgumentError


def checked_probes(probes: Float[np.ndarray, "n p"], pixels: int) -> Float[np.ndarray, "n p"]:
    """Return `probes` if they are finite, of that many pixels, and none is all black."""
    probes = checks.finite("probes", probes)
    if probes.shape[1] != pixels:
        raise ArgumentError(
            f"probes must have {pixels} pixels as the subspaces have, got {probes.shape[1]}; "
            "resize them"
        )
    black = np.flatnonzero(np.einsum("np,np->n", probes, probes) == 0)
    if black.size:
        raise ArgumentError(
            f"probes must not be all black, but {black.size} of {len(probes)} are "
            f"(first: number {black[0]})"
        )
    return probes
