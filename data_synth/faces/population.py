"""People: from a seed to parameters, from parameters to a head."""

from collections.abc import Mapping
from dataclasses import dataclass
from functools import lru_cache

import numpy as np

from .albedo import LUMINANCE, melanin_of_tone
from .parameters import MEAN, PARAMETERS
from .surface import Figure, mean_surface
from .template import build_template

MIN_VERTICES, MAX_VERTICES = 5_000, 200_000


@dataclass(frozen=True)
class Head:
    """A head as a triangle mesh, open at the neck.

    The frame is right-handed: x to the viewer's right, y up, z out of the face; the origin lies
    in the middle of the head at the height of the eyes.

    Attributes
    ----------
    vertices
        `(V, 3)` float64, millimetres.
    faces
        `(F, 3)` int32, counter-clockwise seen from outside.
    normals
        `(V, 3)` float64 unit outward normals of the surface that the mesh samples.
    albedo
        `(V, 3)` float64 linear RGB in [0, 1].
    uvs
        `(V, 2)` float64 in [0, 1]: the disc that the head unfolds to, crown in the middle, face
        above, nape below, the neck's edge its rim.
    parameters
        Everything that makes this person, by name, in the units of `PARAMETERS`.
    """

    vertices: np.ndarray
    faces: np.ndarray
    normals: np.ndarray
    albedo: np.ndarray
    uvs: np.ndarray
    parameters: dict[str, float]

    @property
    def luminance_albedo(self) -> np.ndarray:
        """`(V,)` monochrome albedo: the Rec. 709 luminance of the linear RGB one."""
        return self.albedo @ LUMINANCE


def sample_identity(
    rng: np.random.Generator | int, identity_scale: float = 1.0
) -> dict[str, float]:
    """Draw one person's parameters.

    Each parameter is normal with the mean and spread that `PARAMETERS` gives, tied to the
    person's hidden traits and held within its limits. Melanin instead follows the tone, which is
    uniform, so that light and dark skins are equally frequent.

    Parameters
    ----------
    rng
        Generator or seed.
    identity_scale
        Factor in [0, 2] on every difference from the mean face: 0 makes clones of it.

    Examples
    --------
    >>> sample_identity(7) == sample_identity(7)
    True
    >>> sample_identity(7, identity_scale=0.0)["mouth_width"]
    52.0
    """
    if not 0 <= identity_scale <= 2:
        raise ValueError(f"identity_scale: a number in [0, 2] is required, got {identity_scale}")
    rng = np.random.default_rng(rng)
    tone = rng.uniform(-1, 1)
    traits = np.append(rng.normal(size=3), tone * np.sqrt(3))  # sex, weight, age, tone
    own = rng.normal(size=len(PARAMETERS))
    person = {}
    for parameter, noise in zip(PARAMETERS, own, strict=True):
        tie = np.array(parameter.ties)
        score = tie @ traits + np.sqrt(1 - tie @ tie) * noise
        person[parameter.name] = parameter.mean + identity_scale * parameter.spread * score
    melanin = melanin_of_tone(tone)
    person["melanin"] = MEAN["melanin"] + identity_scale * (melanin - MEAN["melanin"])
    pattern = rng.integers(2**31)
    person["relief_pattern"] = pattern if identity_scale > 0 else MEAN["relief_pattern"]
    return {q.name: float(np.clip(person[q.name], q.low, q.high)) for q in PARAMETERS}


def build_head(parameters: Mapping[str, float], n_vertices: int = 20_000) -> Head:
    """Make the head of the given parameters; those not named keep the mean face's value.

    Parameters
    ----------
    parameters
        Values by name, within the limits of `PARAMETERS`.
    n_vertices
        From 5,000 to 200,000; the mesh may have one vertex fewer.

    Examples
    --------
    >>> long_nose = build_head({"nose_height": 60.0}, n_vertices=5_000)
    >>> long_nose.vertices.shape[1], long_nose.parameters["mouth_width"]
    (3, 52.0)
    """
    _check_parameters(parameters)
    if not (
        isinstance(n_vertices, int | np.integer) and MIN_VERTICES <= n_vertices <= MAX_VERTICES
    ):
        raise ValueError(
            f"n_vertices: an integer from {MIN_VERTICES} to {MAX_VERTICES} is required, "
            f"got {n_vertices!r}"
        )
    figure = _figure(int(n_vertices))
    person = MEAN | {name: float(value) for name, value in parameters.items()}
    vertices, normals, albedo = figure(person)
    return Head(vertices, figure.faces.copy(), normals, albedo, figure.uvs.copy(), person)


def head(seed: int, *, identity_scale: float = 1.0, n_vertices: int = 20_000) -> Head:
    """Make the head of subject `seed`: the same person at any resolution."""
    if not (isinstance(seed, int | np.integer) and seed >= 0):
        raise ValueError(f"seed: an integer of at least 0 is required, got {seed!r}")
    return build_head(sample_identity(int(seed), identity_scale), n_vertices)


def mean_head(n_vertices: int = 20_000) -> Head:
    """Make the mean face of the population."""
    return build_head({}, n_vertices)


def _check_parameters(parameters: Mapping[str, float]) -> None:
    unknown = sorted(set(parameters) - set(MEAN))
    if unknown:
        raise ValueError(f"parameters: names from PARAMETERS are required, got {unknown[0]!r}")
    for q in PARAMETERS:
        value = parameters.get(q.name, q.mean)
        if not q.low <= value <= q.high:
            raise ValueError(
                f"parameters[{q.name!r}]: {q.low:g} to {q.high:g} {q.unit} is required, got {value}"
            )


@lru_cache(maxsize=2)
def _figure(n_vertices: int) -> Figure:
    return Figure(build_template(n_vertices, mean_surface))
