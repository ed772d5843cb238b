"""Every method by its name."""

from collections.abc import Callable
from dataclasses import replace

from harmface.errors import ArgumentError
from harmface.recognition import baselines
from harmface.recognition.distance import Distance
from harmface.recognition.gallery import HARMONIC, RELIT, SHADOWED, Gallery
from harmface.recognition.glossy import GlossyDistance
from harmface.recognition.illumination_cone import ConeDistance
from harmface.recognition.local_subspace import LocalDistance
from harmface.recognition.noise import LikelihoodDistance
from harmface.recognition.non_negative import NonNegativeDistance
from harmface.recognition.non_negative_4d import NonNegativeDistance4D
from harmface.recognition.normalizers import NORMALIZERS, NormalizedDistance
from harmface.recognition.robust import RobustDistance
from harmface.recognition.spanned import SubspaceDistance
from harmface.recognition.whitened import WhitenedDistance

BEST = "best"
"""The method to use, whatever the gallery holds."""


def _registered() -> Distance:
    # OpenCV takes a while to load: what needs it is imported where it is asked for.
    from harmface.recognition.registration import RegisteredDistance

    return RegisteredDistance()


def _lbph() -> Distance:
    from harmface.recognition.lbph import LbphDistance

    return LbphDistance()


def _dlib() -> Distance:
    from harmface.recognition.peers import DlibDistance

    return DlibDistance()


METHODS: dict[str, Callable[[], Distance]] = {
    "local": LocalDistance,
    "whitened": WhitenedDistance,
    "robust": RobustDistance,
    "registered": _registered,
    "subspace": SubspaceDistance,
    "likelihood": LikelihoodDistance,
    "cone": ConeDistance,
    "3d": lambda: SubspaceDistance(HARMONIC, 3, 1),
    "4d": lambda: SubspaceDistance(HARMONIC, 4),
    "9d": lambda: SubspaceDistance(HARMONIC, 9),
    "16d": lambda: SubspaceDistance(SHADOWED, 16),
    "25d": lambda: SubspaceDistance(SHADOWED, 25),
    "glossy": GlossyDistance,
    "non-negative-4d": NonNegativeDistance4D,
    "non-negative-9d": NonNegativeDistance,
    "correlation": baselines.CorrelationDistance,
    "nearest": baselines.PixelDistance,
    "eigenfaces": baselines.EigenfacesDistance,
    "eigenfaces-3": lambda: baselines.EigenfacesDistance(left_out=3),
    "fisherfaces": baselines.FisherfacesDistance,
    "gradient-direction": baselines.GradientDirectionDistance,
    "lbph": _lbph,
    "dlib": _dlib,
}
"""Distances by name: to photographs, but glossy and those with a dimension in their name are to
harmonic images, with attached shadows up to 9 dimensions and with cast shadows beyond."""

FRAMED = "framed"
"""What stands before a method, with a plus, to search for how probes are framed."""

BEFORE = (FRAMED, RELIT, HARMONIC, SHADOWED, *NORMALIZERS)
"""What may stand before a name, with a plus: how probes are framed, one of what subjects are known
by, and one of what is done to photographs."""


def distance_named(name: str) -> Distance:
    """Return the distance of a name, other than "best".

    Parameters
    ----------
    name
        One of `METHODS`, with words of `BEFORE` and a plus before it if wanted, such as
        "shadowed+robust" or "framed+relit+local".

    Returns
    -------
    Distance
        With the defaults of its class.

    Raises
    ------
    ArgumentError
        If there is no such method, or it cannot do with what stands before it.
    """
    *before, method = name.split("+")
    sources = [word for word in before if word not in (FRAMED, *NORMALIZERS)]
    normalizers = [word for word in before if word in NORMALIZERS]
    known = method in METHODS and set(before) <= set(BEFORE) and before.count(FRAMED) < 2
    if not known or len(sources) > 1 or len(normalizers) > 1:
        raise ArgumentError(
            f"method must be {BEST}, or one of {', '.join(METHODS)}, or one of {', '.join(BEFORE)} "
            f"and a plus before it, got {name!r}"
        )
    distance = METHODS[method]()
    if normalizers and distance.of_surfaces:
        raise ArgumentError(f"method {method} must have photographs for {normalizers[0]}+")
    for source in sources:
        if source not in distance.sources:
            raise ArgumentError(
                f"method {method} must have one of {', '.join(distance.sources)}, got {source!r}"
            )
        distance = replace(distance, source=source)
    if normalizers:
        source = distance.source
        distance = NormalizedDistance(source, normalizers[0], distance)
    if FRAMED in before:
        from harmface.recognition.framed import FramedDistance

        distance = FramedDistance(distance.source, distance)
    return distance


def best_method(gallery: Gallery, learning: bool | None = None) -> str:
    """Return the name of the method to use with a gallery.

    Of meshes it is what told procedural heads apart by the widest margin; of photographs
    `whitened`, where there are other people to learn from, and `local` where there are none, under
    known light with relit photographs. Each is searched for how probes are framed, but of
    photographs that are aligned, or of one row, which is no picture.

    Parameters
    ----------
    gallery
        What was enrolled.
    learning
        Whether there are other people to learn from; by default whether the gallery holds them.

    Returns
    -------
    str
        Such as `distance_named` takes.
    """
    if gallery.harmonic is not None:
        return f"{FRAMED}+25d"
    learning = gallery.others is not None if learning is None else learning
    alone = "local" if gallery.lights is None else f"{RELIT}+local"
    name = "whitened" if learning else alone
    fixed = gallery.aligned or min(gallery.mask.shape) == 1
    return name if fixed else f"{FRAMED}+{name}"
