"""A window, or a notebook's cell, of pyvista with a mesh and sliders for its light."""

from typing import TYPE_CHECKING, Any

import numpy as np
from jaxtyping import Float

from harmface import checks
from harmface.conventions import degree_order, linear_to_srgb
from harmface.errors import ArgumentError
from harmface.geometry import Mesh
from harmface.light import EnvironmentMap, project, published_probe
from harmface.rendering import irradiance_matrix, matrix_irradiance

if TYPE_CHECKING:
    import pyvista as pv

BRIGHTEST = 0.95
"""Where the brightest half percent of the vertices lies at first, as a share of white."""


def interactive(
    mesh: Mesh,
    light: EnvironmentMap | Float[np.ndarray, "*channels K"] | None = None,
    **plotter_options: Any,
) -> "pv.Plotter":
    """Return a pyvista plotter of a mesh under a light, with a slider for each of nine numbers.

    Vertices show `albedo E(n)` with `E(n) = (n, 1)^T M (n, 1)` (RH01 eq. 11); VTK's own lights are
    off. Sliders move all channels of the light alike.

    Parameters
    ----------
    mesh
        The object; its albedo is that of its vertices.
    light
        A map or coefficients of one channel or three; Grace Cathedral if not given.
    **plotter_options
        For `pyvista.Plotter`, such as `notebook=True` or `off_screen=True`.

    Returns
    -------
    pyvista.Plotter
        Ready to `show()`; anything else of pyvista can be added first.

    Raises
    ------
    ArgumentError
        If there are other numbers of channels or fewer than nine coefficients.
    """
    import pyvista as pv  # takes a second to load

    found = project(light, 2) if isinstance(light, EnvironmentMap) else light
    found = published_probe("grace") if found is None else found
    found = np.atleast_2d(checks.finite("light", found))[:, :9]
    if found.shape not in ((1, 9), (3, 9)):
        raise ArgumentError(
            "light must have one channel or three of at least nine coefficients, got shape "
            f"{found.shape}"
        )
    current = np.array(np.broadcast_to(found, (3, 9)))
    bright = np.percentile(_radiosity(mesh, current), 99.5)
    exposure = BRIGHTEST / bright if bright > 0 else 1.0

    surface = pv.PolyData.from_regular_faces(mesh.vertices, mesh.faces)
    surface["colour"] = _colours(mesh, current, exposure)
    plotter = pv.Plotter(lighting="none", **plotter_options)
    plotter.add_mesh(surface, scalars="colour", rgb=True, lighting=False)
    plotter.view_xy()
    reach = 2 * np.abs(current).max() or 1.0

    def moved(k: int, value: float) -> None:
        current[:, k] += value - current[:, k].mean()
        surface["colour"] = _colours(mesh, current, exposure)

    for k in range(9):
        degree, order = degree_order(k)
        height = 0.94 - 0.1 * k
        plotter.add_slider_widget(
            lambda value, k=k: moved(k, value),
            rng=(-reach, reach),
            value=float(current[:, k].mean()),
            title=f"L{degree}{order}",
            pointa=(0.76, height),
            pointb=(0.98, height),
            style="modern",
            title_height=0.018,
        )
    return plotter


def _radiosity(mesh: Mesh, light: Float[np.ndarray, "3 9"]) -> Float[np.ndarray, "V 3"]:
    return mesh.albedo * matrix_irradiance(irradiance_matrix(light), mesh.normals).T


def _colours(
    mesh: Mesh, light: Float[np.ndarray, "3 9"], exposure: float
) -> Float[np.ndarray, "V 3"]:
    return linear_to_srgb(np.clip(exposure * _radiosity(mesh, light), 0, 1))
