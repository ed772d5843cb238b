"""The linear map that brings a structure nearest to given normals."""

import numpy as np
from jaxtyping import Float

ROUNDING = 1e-12
"""Share of the energy in the strongest dimension below which another one is empty."""

ROUNDS = 10
"""Rounds in which a linear map settles: its scale changes at each pixel with the map."""


def nearest_linear_map(
    structure: Float[np.ndarray, "p d"], normals: Float[np.ndarray, "p 3"]
) -> Float[np.ndarray, "3 d"]:
    """Return the T whose T v have the directions of given unit normals, lengths left free.

    It minimises the sum of the squared sines of the angles, `N / D` with `N = |(I - n n') T v|^2`
    and `D = |T v|^2`. Where the sum is least so is that of `(N - q D) / D_0`, q and D_0 being N / D
    and D there: a quadratic form in T, whose least eigenvector is T, found in rounds. The best
    round counts.

    Parameters
    ----------
    structure
        v, d numbers a pixel.
    normals
        n.
    """
    weight = 1 / np.maximum((structure**2).sum(axis=1), np.finfo(np.float64).tiny)
    # White coordinates, so that T of unit size does not shrink the normals along faint dimensions;
    # those of nothing but rounding are left out.
    spread, axes = np.linalg.eigh((structure * weight[:, None]).T @ structure)
    kept = spread > ROUNDING * spread[-1]
    whitening = axes[:, kept] / np.sqrt(spread[kept])
    white = structure @ whitening
    weight = 1 / np.maximum((white**2).sum(axis=1), np.finfo(np.float64).tiny)
    size = white.shape[1]
    # Products that no round changes.
    of_white = (white[:, :, None] * white[:, None, :]).reshape(len(white), -1)
    of_normals = (normals[:, :, None] * normals[:, None, :]).reshape(len(normals), -1)
    sine, least = np.zeros(len(normals)), np.inf
    for done in range(2 * ROUNDS):
        across = np.outer(1 - sine, np.eye(3)) - of_normals
        form = ((weight[:, None] * across).T @ of_white).reshape(3, 3, size, size)
        form = form.swapaxes(1, 2).reshape(3 * size, 3 * size)
        tried = np.linalg.eigh(form)[1][:, 0].reshape(3, size)
        mapped = white @ tried.T
        weight = 1 / np.maximum((mapped**2).sum(axis=1), np.finfo(np.float64).tiny)
        sines = 1 - (mapped * normals).sum(axis=1) ** 2 * weight
        if sines.sum() < least:
            rows, least = tried * np.sign((mapped * normals).sum()), sines.sum()
        # Half of the rounds bring the weights near; from further off, the rest would not settle.
        sine = sines if done >= ROUNDS else sine
    return np.asarray(rows @ whitening.T)
