"""First-order structure up to a Lorentz transformation.

Under light of degree 1 the images have rank 4 and their structure is S = (|b|, b) times
constants, one null vector of the metric J = diag(1, -1, -1, -1) a pixel. A factorisation gives v
= A^-1 S for an unknown 4 x 4 matrix A, so every pixel obeys `v^T B v = 0`, B = A^T J A: linear in
the ten entries of B ([BJK07]_ sect. 4.1). With B known, any W with B = W^T J W gives null vectors
W v; two such W differ by a Lorentz transformation and a scale.

References
----------
.. [BJK07] Basri, Jacobs and Kemelmacher, Photometric Stereo with General, Unknown Lighting,
   IJCV 2007.
"""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float
from scipy.optimize import least_squares
from scipy.spatial.transform import Rotation

from harmface.errors import ArgumentError

METRIC = np.diag([1.0, -1.0, -1.0, -1.0])
"""J: the sign of albedo squared against the three squared components of the scaled normal."""


EXACT = 1e-5
"""Residual of the null cone up to which light counts as of degree 1: higher degrees leave 1e-2."""


@dataclass(frozen=True, eq=False)
class NullCone:
    """The quadric on which the structure of all pixels lies.

    Parameters
    ----------
    form
        B, scaled to unit Frobenius norm, with one positive eigenvalue.
    frame
        W with B = W^T J W: `frame @ v` is a null vector of J.
    residual
        Root mean square of `v^T B v` over pixels, v scaled to unit length in whitened axes.
    signature_held
        Whether B came out with signature (1, 3); if not, eigenvalues changed sign to give it.
    """

    form: Float[np.ndarray, "4 4"]
    frame: Float[np.ndarray, "4 4"]
    residual: float
    signature_held: bool

    @property
    def exact(self) -> bool:
        """Whether light was of degree 1."""
        return self.residual <= EXACT


def fit_null_cone(structure: Float[np.ndarray, "4 p"]) -> NullCone:
    """Return the quadric that the structure of rank 4 lies on.

    B's ten unknowns are the null vector of a p x 10 system whose columns are v_i v_j, those with
    i < j doubled since B is symmetric. Pixels count alike: v is whitened over the pixels and
    scaled to unit length first. Noise, and light beyond degree 1, can leave B with the wrong
    signature; then the eigenvector along which the pixels lie on average is taken as the one
    of positive eigenvalue, and the others are made negative.

    Parameters
    ----------
    structure
        Rank-4 factor, one column a pixel.

    Returns
    -------
    NullCone
        The form and the frame that makes it Lorentz's, both 4 x 4.

    Raises
    ------
    ArgumentError
        If the pixels span fewer than four dimensions.
    """
    left, values, _ = np.linalg.svd(structure @ structure.T)
    if values[3] <= 1e-14 * values[0]:
        raise ArgumentError(
            "images must have rank 4 for the first-order method, got fewer dimensions; add "
            "photographs under other light, or say that the sources are points"
        )
    whiten = (left / np.sqrt(values)).T
    v = whiten @ structure
    length = np.linalg.norm(v, axis=0)
    v = v[:, length > 0] / length[length > 0]
    i, j = np.triu_indices(4)
    design = (v[i] * v[j] * np.where(i == j, 1.0, 2.0)[:, None]).T
    _, singular, rows = np.linalg.svd(np.linalg.qr(design, mode="r"))
    form = np.empty((4, 4))
    form[i, j] = form[j, i] = rows[-1]
    eigenvalues, axes = np.linalg.eigh(form)
    if (eigenvalues > 0).sum() > 2 or ((eigenvalues > 0).sum() == 2 and eigenvalues.sum() < 0):
        eigenvalues, form = -eigenvalues, -form
    held = int((eigenvalues > 0).sum()) == 1
    along = axes.T @ v
    time = int(eigenvalues.argmax()) if held else int(np.abs(along.mean(axis=1)).argmax())
    order = [time, *(k for k in range(4) if k != time)]
    # A vanishing eigenvalue would leave a frame that cannot be inverted.
    size = np.maximum(np.abs(eigenvalues), 1e-6 * np.abs(eigenvalues).max())[order]
    frame = np.sqrt(size)[:, None] * axes[:, order].T @ whiten
    if (frame[0] @ structure).sum() < 0:
        frame[0] *= -1
    form = frame.T @ METRIC @ frame
    scale = np.linalg.norm(form)
    return NullCone(
        form / scale, frame / np.sqrt(scale), float(singular[-1] / np.sqrt(v.shape[1])), held
    )


def lorentz_deviation(transformation: Float[np.ndarray, "4 4"]) -> float:
    """Return how far A is from a scaled Lorentz transformation.

    For one, `A^T J A = c J`; the result is the largest entry of `A^T J A / c - J`, with c the
    mean of the four that the diagonal gives.

    Parameters
    ----------
    transformation
        The matrix A.

    Returns
    -------
    float
        0 for a Lorentz transformation times a number.

    Examples
    --------
    >>> boost = lorentz_transformation(np.array([0.1, 0.2, 0.3, 0.0, 0.0, 1.0]))
    >>> lorentz_deviation(3 * boost) < 1e-13
    True
    """
    product = transformation.T @ METRIC @ transformation
    scale = np.trace(product @ METRIC) / 4
    return float(np.abs(product / scale - METRIC).max())


def lorentz_transformation(parameters: Float[np.ndarray, "6"]) -> Float[np.ndarray, "4 4"]:
    """Return the boost of rapidities `parameters[:3]` followed by the rotation `parameters[3:]`.

    Rapidities and rotation are vectors along x, y, z; the rotation's length is its angle.
    """
    rapidity = np.linalg.norm(parameters[:3])
    axis = parameters[:3] / max(rapidity, np.finfo(np.float64).tiny)
    boost, turn = np.eye(4), np.eye(4)
    boost[0, 0] = np.cosh(rapidity)
    boost[0, 1:] = boost[1:, 0] = np.sinh(rapidity) * axis
    boost[1:, 1:] += (np.cosh(rapidity) - 1) * np.outer(axis, axis)
    turn[1:, 1:] = Rotation.from_rotvec(parameters[3:]).as_matrix()
    return turn @ boost


def nearest_lorentz(
    normals: Float[np.ndarray, "p 3"], target: Float[np.ndarray, "p 3"]
) -> Float[np.ndarray, "4 4"]:
    """Return the Lorentz transformation, reflected or not, that takes normals nearest to others.

    A null vector (1, n) goes to a multiple of (1, n'), so normals move as a conformal map of the
    sphere; n' is compared with the target.
    """
    left, _, right = np.linalg.svd(target.T @ normals)
    turn = np.eye(4)
    turn[1:, 1:] = left @ right
    null = turn @ np.concatenate([np.ones((1, len(normals))), normals.T])

    def missed(parameters: Float[np.ndarray, "6"]) -> Float[np.ndarray, "r"]:
        image = lorentz_transformation(parameters) @ null
        return np.asarray((image[1:] / image[0] - target.T).ravel())

    fit = least_squares(missed, np.zeros(6), xtol=1e-15, ftol=1e-15, gtol=1e-15)
    return lorentz_transformation(fit.x) @ turn
