"""Light and reflectance together, from nothing but the field that is reflected.

References
----------
.. [R05] Ramamoorthi, Modeling Illumination Variation with Spherical Harmonics, in Face
   Processing: Advanced Modeling Methods, 2005.
.. [RH01b] Ramamoorthi and Hanrahan, A Signal-Processing Framework for Inverse Rendering,
   SIGGRAPH 2001.
"""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Bool, Float

from harmface import checks
from harmface.conventions import degrees, max_degree_of
from harmface.errors import ArgumentError
from harmface.summaries import summary


@dataclass(frozen=True, eq=False)
class Factorization:
    """A light and a material whose product is a reflected field.

    Parameters
    ----------
    light
        Coefficients of radiance, of unit norm, `L_00` not negative; zero where not determined.
    rho
        Coefficients `rho_lpq` that go with it.
    light_errors, rho_errors
        Standard errors of both; infinite where not determined.
    determined
        Whether a degree is tied to the others by reciprocity.
    second
        Second singular value of each degree's matrix over the largest of all: 0 for a field that
        one light and one isotropic material make.
    """

    light: Float[np.ndarray, "K"]
    rho: Float[np.ndarray, "L L L"]
    light_errors: Float[np.ndarray, "K"]
    rho_errors: Float[np.ndarray, "L L L"]
    determined: Bool[np.ndarray, "L"]
    second: Float[np.ndarray, "L"]

    __repr__ = summary


def factorize(
    field: Float[np.ndarray, "..."],
    *,
    noise: float = 0.0,
    draws: int = 100,
    rng: np.random.Generator | int = 0,
) -> Factorization:
    """Separate a reflected field into light and material, up to one scale, [RH01b]_ section 4.

    For each degree the matrix `B_m,(pq) = L_lm rho_lpq` has rank 1, which gives both up to a
    factor `s_l`. Times the cosine of the outgoing direction a reflectance is reciprocal,
    `rho_lpq = rho_plq`, and so the factors are tied: `s_l v_lpq = s_p v_plq` for all `p` and `q`
    is solved by least squares. One scale for all is left.

    Parameters
    ----------
    field
        Coefficients `B_lmpq` of the field times the cosine of the outgoing direction, shape
        `(L**2, L, L)`, degrees `l` and `p` alike, see `reflected_field`.
    noise
        Standard deviation of the field's coefficients.
    draws
        Number of fields with noise drawn anew, from which the standard errors come.
    rng
        Generator or seed.

    Returns
    -------
    Factorization
        Light and material, with standard errors if there is noise.

    Raises
    ------
    ArgumentError
        If the field has another shape, is dark, or has fewer than two degrees.
    """
    field = checks.finite("field", field)
    rng = checks.generator(rng)
    if field.ndim != 3 or len({field.shape[1] ** 2, field.shape[2] ** 2, len(field)}) > 1:
        raise ArgumentError(
            f"field must have shape (L**2, L, L), its degrees l and p alike, got {field.shape}"
        )
    if len(field) < 4:
        raise ArgumentError("field must have degree 1 or more: reciprocity ties two degrees")
    if not np.abs(field).max() > 0:
        raise ArgumentError("field must not be dark")
    light, rho, determined, second = _separate(field, noise)
    errors = np.zeros(len(light)), np.zeros(rho.shape)
    if noise > 0:
        exact = light[:, None, None] * rho[degrees(max_degree_of(len(light)))]
        row, column, q = np.indices(rho.shape)
        exists = (q <= np.minimum(row, column))[degrees(max_degree_of(len(light)))]
        drawn = [
            _separate(exact + noise * exists * rng.standard_normal(field.shape), noise, determined)
            for _ in range(checks.positive_integer("draws", draws))
        ]
        errors = (
            np.sqrt(np.mean([(each[0] - light) ** 2 for each in drawn], axis=0)),
            np.sqrt(np.mean([(each[1] - rho) ** 2 for each in drawn], axis=0)),
        )
    unknown = ~determined
    errors[0][unknown[degrees(max_degree_of(len(light)))]] = np.inf
    errors[1][unknown] = np.inf
    return Factorization(light, rho, *errors, determined, second)


def _separate(
    field: Float[np.ndarray, "..."],
    noise: float,
    among: Bool[np.ndarray, "L"] | None = None,
) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
    """Return light, material, which degrees are determined, and the second singular values."""
    count = field.shape[1]
    left, right = np.zeros(len(field)), np.zeros((count, count, count))
    first, second = np.zeros(count), np.zeros(count)
    for l in range(count):  # noqa: E741 - the field's name for it
        block = slice(l**2, (l + 1) ** 2)
        u, s, v = np.linalg.svd(field[block].reshape(2 * l + 1, -1), full_matrices=False)
        left[block], right[l] = u[:, 0], s[0] * v[0].reshape(count, count)
        first[l], second[l] = s[0], s[1] if len(s) > 1 else 0
    # A degree counts if its matrix stands out of the noise: such a matrix of noise alone has a
    # largest singular value of about the root of its rows plus that of its columns.
    rows = np.sqrt(2 * np.arange(count) + 1)
    floor = np.maximum(noise * (rows + count), 1e-10 * first.max())
    bright = first > floor if among is None else among
    # s_l v_lpq - s_p v_plq: rows are the pairs of degrees, columns the factors of the degrees.
    ties = []
    for high in np.flatnonzero(bright):
        for low in np.flatnonzero(bright[:high]):
            row = np.zeros((high + 1, count))
            row[:, high] = right[high, low, : high + 1]
            row[:, low] = -right[low, high, : high + 1]
            ties.append(row)
    linked = _linked(right, bright, floor) if among is None else among
    scale = np.zeros(count)
    members = np.flatnonzero(linked)
    if len(members) > 1:
        # Columns of like size: the smallest singular vector then favours no degree.
        system = np.concatenate(ties)[:, members]
        size = np.linalg.norm(system, axis=0)
        scale[members] = np.linalg.svd(system / size)[2][-1] / size
    else:
        scale[members] = 1
    expanded = scale[degrees(count - 1)]
    light = np.divide(left, expanded, out=np.zeros_like(left), where=expanded != 0)
    norm = np.linalg.norm(light) * (1 if light[0] > 0 or light[0] == 0 else -1)
    return light / norm, right * scale[:, None, None] * norm, linked, second / first.max()


def _linked(
    right: Float[np.ndarray, "L L L"], bright: Bool[np.ndarray, "L"], floor: Float[np.ndarray, "L"]
) -> Bool[np.ndarray, "L"]:
    """Return the degrees that ties connect with the brightest one, on both sides above noise."""
    from scipy.sparse.csgraph import connected_components

    strength = np.linalg.norm(right, axis=-1) > floor[:, None]
    tied = strength & strength.T & bright & bright[:, None]
    group = connected_components(tied, directed=False)[1]
    brightest = int(np.linalg.norm(right, axis=(1, 2)).argmax())
    return bright & (group == group[brightest])


@dataclass(frozen=True)
class Consistency:
    """Whether photographs of two objects can be of the same two lights.

    Parameters
    ----------
    chi_square
        Sum of the squared deviations over their variances.
    freedom
        Number of coefficients that tell.
    p_value
        Probability of a sum as large if they are consistent.
    """

    chi_square: float
    freedom: int
    p_value: float


def consistent_light(
    first: Float[np.ndarray, "2 K"],
    second: Float[np.ndarray, "2 K"],
    first_errors: Float[np.ndarray, "2 K"],
    second_errors: Float[np.ndarray, "2 K"],
) -> Consistency:
    """Test whether two objects in two photographs were lit alike, their materials unknown.

    If objects 1 and 2 share the light of each photograph, `B11 B22 = B12 B21` for every
    coefficient ([RH01b]_ section 4.4): of each product one factor of light and material comes from
    either. An object that was pasted in breaks it.

    Parameters
    ----------
    first, second
        Coefficients of the reflected radiance, by the mirrored direction or the normal, of both
        objects in the first and in the second photograph.
    first_errors, second_errors
        Their standard errors, above 0.

    Returns
    -------
    Consistency
        With a small probability where the lights differ.

    Raises
    ------
    ArgumentError
        If shapes differ, an error is not above 0, or every product is lost in noise.
    """
    from scipy.stats import chi2

    values = np.stack([checks.finite("first", first), checks.finite("second", second)])
    errors = np.stack([first_errors, second_errors])
    if values.shape != errors.shape or values.shape[1] != 2 or not (errors > 0).all():
        raise ArgumentError(
            "consistent_light takes coefficients (2, K) of two objects and standard errors above 0 "
            f"of the same shape, got {values.shape[1:]} and {errors.shape[1:]}"
        )
    deviation = values[0, 0] * values[1, 1] - values[1, 0] * values[0, 1]
    partner = values[::-1, ::-1]
    variance = ((partner * errors) ** 2).sum(axis=(0, 1))
    # Where both products are within noise of zero their difference is not normal, and tells little.
    telling = (np.abs(values) > 3 * errors).sum(axis=(0, 1)) >= 2
    if not telling.any():
        raise ArgumentError("every coefficient is lost in noise: the light cannot be compared")
    total = float((deviation[telling] ** 2 / variance[telling]).sum())
    freedom = int(telling.sum())
    return Consistency(total, freedom, float(chi2.sf(total, freedom)))
