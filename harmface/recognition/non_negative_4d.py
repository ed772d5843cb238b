"""The nearest image under non-negative light of degree 1, in closed form.

Harmonic coefficients `(l_0, l_1)` to degree 1 are those of some light that is nowhere negative
exactly if `|l_1| <= sqrt(3) l_0`: a cone whose boundary is that of single lamps. The nearest point
of a round cone in the metric of the images is found from the roots of a polynomial of degree 6
([BJ03]_, section 3.4).

References
----------
.. [BJ03] Basri and Jacobs, Lambertian Reflectance and Linear Subspaces, PAMI 2003.
"""

import numpy as np
from jaxtyping import Bool, Float

from harmface.errors import ArgumentError
from harmface.recognition.distance import Model
from harmface.recognition.non_negative import NonNegativeDistance, small_problems

CONE = np.array([-3.0, 1.0, 1.0, 1.0])
"""Diagonal of the quadratic form that is at most 0 for non-negative light."""


def non_negative_distances_4d(
    probes: Float[np.ndarray, "n p"], images: Float[np.ndarray, "N 4 p"]
) -> Float[np.ndarray, "n N"]:
    """Return the distance of every probe to every subject under non-negative light of degree 1.

    Relative to the probe's norm as `subspace_distances`.

    Parameters
    ----------
    probes
        Images as rows of pixels; none may be all black.
    images
        Harmonic images of each subject to degree 1, linearly independent.

    Returns
    -------
    numpy.ndarray
        Shape (n, N), in [0, 1], in the probes' dtype.

    Raises
    ------
    ArgumentError
        On NaN, an all-black probe, probes of another size than the images, another number of
        harmonic images, or dependent ones.
    """
    if images.shape[1] != 4:
        raise ArgumentError(f"images must be 4 of each subject, got {images.shape[1]}")
    projections, grams, squared = small_problems(probes, images)
    light = nearest_in_round_cone(projections, grams)
    fitted = np.einsum("nsk,skl,nsl->ns", light, grams, light, optimize=True)
    relative = 1 + (fitted - 2 * (light * projections).sum(axis=-1)) / squared[:, None]
    return np.sqrt(np.maximum(relative, 0)).astype(probes.dtype)


def nearest_in_round_cone(
    projections: Float[np.ndarray, "n N 4"], grams: Float[np.ndarray, "N 4 4"]
) -> Float[np.ndarray, "n N 4"]:
    """Return the light of least `l G l - 2 l q` with `|l_1| <= sqrt(3) l_0`.

    Candidates are the free minimum, darkness, and where on the cone `(G + t D) l = q` with
    `D = diag(CONE)`; the best of those that are within the cone is the minimum.

    Parameters
    ----------
    projections
        The vectors `q` of every problem.
    grams
        The matrices `G` of every subject.
    """
    values, vectors = np.linalg.eigh(grams)
    if (values[:, 0] <= 1e-12 * values[:, -1]).any():
        raise ArgumentError("images of a subject must be linearly independent")
    # In the basis where G is the identity and D the diagonal `form`, l(t) = y / (1 + t form).
    whiten = vectors / np.sqrt(values)[:, None]
    form, turn = np.linalg.eigh(whiten.swapaxes(1, 2) @ (CONE[:, None] * whiten))
    basis = whiten @ turn
    along = np.einsum("skd,nsk->nsd", basis, projections)
    multipliers = _cone_multipliers(along, np.broadcast_to(form, along.shape))
    # A multiplier of 0 is the free minimum, an infinite one darkness.
    multipliers = np.concatenate(
        [np.zeros_like(along[..., :1]), np.full_like(along[..., :1], np.inf), multipliers], axis=-1
    )
    with np.errstate(divide="ignore", invalid="ignore"):
        candidates = along[..., None, :] / (1 + multipliers[..., None] * form[:, None])
        light = np.einsum("skd,nscd->nsck", basis, candidates)
        inside = np.linalg.norm(light[..., 1:], axis=-1) <= np.sqrt(3) * light[..., 0] * (1 + 1e-6)
        cost = (candidates * (candidates - 2 * along[..., None, :])).sum(axis=-1)
    best = np.where(inside, cost, np.inf).argmin(axis=-1)
    return np.take_along_axis(light, best[..., None, None], axis=2)[:, :, 0]


def _cone_multipliers(
    along: Float[np.ndarray, "n N 4"], form: Float[np.ndarray, "n N 4"]
) -> Float[np.ndarray, "n N 6"]:
    """Return the real roots `t` of `sum_d form_d y_d^2 / (1 + t form_d)^2`, NaN for the others."""
    total = np.zeros((*along.shape[:-1], 7))
    for d in range(4):
        product = (form[..., d] * along[..., d] ** 2)[..., None]
        for other in {0, 1, 2, 3} - {d}:
            factor = form[..., other, None]
            for _ in range(2):
                raised = np.pad(product, [(0, 0), (0, 0), (1, 0)]) * factor
                product = np.pad(product, [(0, 0), (0, 0), (0, 1)]) + raised
        total += product
    # Roots of the companion matrix, after t is measured in a unit in which they are near 1.
    lead = total[..., -1:]
    lead = np.where(lead == 0, np.finfo(float).tiny, lead)
    companion = np.zeros((*along.shape[:-1], 6, 6))
    companion[..., range(1, 6), range(5)] = 1
    companion[..., :, -1] = -total[..., :-1] / lead
    roots = np.linalg.eigvals(companion)
    real = np.abs(roots.imag) <= 1e-6 * np.abs(roots)
    return np.where(real, roots.real, np.nan)


class NonNegativeDistance4D(NonNegativeDistance):
    """The `non_negative_distances_4d`."""

    @property
    def harmonics(self) -> slice:
        """Those to degree 1."""
        return slice(0, 4)

    def distances(
        self, model: Model, probes: Float[np.ndarray, "n H W"], mask: Bool[np.ndarray, "H W"]
    ) -> Float[np.ndarray, "n N"]:
        """Return the distance of every probe to every subject, in [0, 1]."""
        return non_negative_distances_4d(probes[:, mask], model["images"].astype(np.float64))

    def light(
        self, probes: Float[np.ndarray, "n p"], images: Float[np.ndarray, "n K p"]
    ) -> Float[np.ndarray, "n K"]:
        """Return the non-negative light under which a subject looks most like each probe."""
        return np.einsum("iik->ik", nearest_in_round_cone(*small_problems(probes, images)[:2]))
