"""What `viewer` is given of a surface from photographs, or of an enrolled subject."""

from collections.abc import Mapping

import matplotlib as mpl
import numpy as np
from jaxtyping import Float

from harmface import checks
from harmface.errors import ArgumentError
from harmface.geometry import depth_to_mesh
from harmface.light import EnvironmentMap
from harmface.recognition import Gallery
from harmface.viz.viewer.page import Viewer, viewer


def confidence_colours(confidence: Float[np.ndarray, "V"]) -> Float[np.ndarray, "V 3"]:
    """Return colours of shares in [0, 1], dark blue to yellow, the same to colour-blind eyes.

    Parameters
    ----------
    confidence
        Share of each vertex; above 1 counts as 1.

    Returns
    -------
    numpy.ndarray
        sRGB in [0, 1], shape (V, 3).

    Raises
    ------
    ArgumentError
        If a share is negative or not finite.
    """
    confidence = checks.non_negative("confidence", confidence)
    return mpl.colormaps["cividis"](np.minimum(confidence, 1))[:, :3]


def subject_viewer(
    gallery: Gallery,
    subject: str,
    light: EnvironmentMap | Float[np.ndarray, "*channels K"] | None = None,
    *,
    light_name: str = "light",
    presets: Mapping[str, Float[np.ndarray, "..."]] | None = None,
) -> Viewer:
    """Return a page that relights the harmonic images of an enrolled subject.

    A pixel's values in all harmonic images are its transfer vector: the picture is `L @ S` for
    the light as it is turned.

    Parameters
    ----------
    gallery
        With harmonic images, as meshes give them; those with cast shadows are taken if it holds
        them.
    subject
        Whose.
    light, light_name, presets
        See `viewer`.

    Returns
    -------
    Viewer
        The page.

    Raises
    ------
    ArgumentError
        If there is no such subject, or the gallery holds no harmonic images.
    """
    known = [str(name) for name in gallery.names]
    if subject not in known:
        shown = ", ".join(known[:10]) + (", ..." if len(known) > 10 else "")
        raise ArgumentError(f"subject must be one of {shown}, got {subject!r}")
    images = gallery.harmonic if gallery.shadowed is None else gallery.shadowed
    if images is None:
        raise ArgumentError(
            "gallery must hold harmonic images, which photographs do not give; enroll meshes"
        )
    own = images[known.index(subject)]
    picture = depth_to_mesh(np.zeros(gallery.mask.shape), gallery.mask)
    return viewer(
        picture,
        light,
        title=subject,
        light_name=light_name,
        presets=presets,
        transfer=own[:, gallery.mask].astype(np.float64),
        flat=True,
    )
