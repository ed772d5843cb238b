"""People: from a seed to parameters, from parameters to a head."""

from collections.abc import Mapping
from dataclasses import dataclass
from functools import lru_cache

import numpy as np

from .albedo import LUMINANCE
from .parameters import MEAN, PARAMETERS
from .surface import Figure, mean_surface
from .template import Template, build_template

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
        `(V, 2)` float64 in [0, 1]: the disc that the head unfolds to, crown in the middle.
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
    """Draw one person's parameters."""
    if not 0 <= identity_scale <= 2:
        raise ValueError(f"identity_scale: a number in [0, 2] is required, got {identity_scale}")
    rng = np.random.default_rng(rng)
    traits = rng.normal(size=3)
    own = rng.normal(size=len(PARAMETERS))
    tone, pattern = rng.uniform(-1, 1), float(rng.integers(2**31))
    traits = np.append(traits, tone * np.sqrt(3.0))
    person = {}
    for parameter, noise in zip(PARAMETERS, own, strict=True):
        tie = np.array([parameter.sex, parameter.weight, parameter.age, parameter.tone])
        free = np.sqrt(max(1 - float(tie @ tie), 0.1))
        value = parameter.mean + identity_scale * parameter.spread * float(
            tie @ traits + free * noise
        )
        person[parameter.name] = float(np.clip(value, parameter.low, parameter.high))
    person["relief_pattern"] = pattern
    melanin = melanin_of_tone(tone)
    person["melanin"] = MEAN["melanin"] + identity_scale * (melanin - MEAN["melanin"])
    person["melanin"] = float(np.clip(person["melanin"], 0.01, 0.43))
    return person


def melanin_of_tone(tone: float) -> float:
    """Melanin from -1 (lightest) to 1 (darkest), even steps of the luminance's square root."""
    root = np.sqrt(0.56) + (tone + 1) / 2 * (np.sqrt(0.075) - np.sqrt(0.56))
    return float(np.log(0.57 / root**2) / 4.7)


def build_head(parameters: Mapping[str, float], n_vertices: int = 20_000) -> Head:
    """Make the head of the given parameters; those not named keep the mean face's value."""
    unknown = sorted(set(parameters) - set(MEAN))
    if unknown:
        raise ValueError(f"parameters: names of PARAMETERS are required, got {unknown[0]!r}")
    figure, template, uvs = _figure(_checked_count(n_vertices))
    person = MEAN | {name: float(value) for name, value in parameters.items()}
    vertices, normals, colour = figure(person)
    return Head(vertices, template.faces.copy(), normals, colour, uvs.copy(), person)


def head(seed: int, *, identity_scale: float = 1.0, n_vertices: int = 20_000) -> Head:
    """The head of subject `seed`; the same subject at any resolution."""
    if seed < 0:
        raise ValueError(f"seed: a non-negative integer is required, got {seed}")
    return build_head(sample_identity(seed, identity_scale), n_vertices)


def mean_head(n_vertices: int = 20_000) -> Head:
    """The mean face of the population."""
    return build_head({}, n_vertices)


def _checked_count(n_vertices: int) -> int:
    if not MIN_VERTICES <= n_vertices <= MAX_VERTICES:
        raise ValueError(
            f"n_vertices: an integer from {MIN_VERTICES} to {MAX_VERTICES} is required, "
            f"got {n_vertices}"
        )
    return int(n_vertices)


@lru_cache(maxsize=4)
def _figure(n_vertices: int) -> tuple[Figure, Template, np.ndarray]:
    template = build_template(n_vertices, mean_surface)
    half = template.points
    disc = np.concatenate([half, half[template.paired] * [-1.0, 1.0]])
    return Figure(template), template, 0.5 + 0.5 * disc
