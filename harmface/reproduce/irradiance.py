"""Claims on irradiance from nine coefficients."""

import time
from collections.abc import Callable, Mapping
from functools import lru_cache

import numpy as np
from matplotlib.figure import Figure

from data_synth.environments import ENVIRONMENTS, rasterise
from data_synth.faces import mean_head
from data_synth.shapes import sphere
from harmface.geometry import Mesh, frame_orthographic, gbuffer
from harmface.light import EnvironmentMap, layout_named, project, published_probe
from harmface.light.published import PUBLISHED_PROBES
from harmface.rendering import (
    harmonic_images,
    harmonic_irradiance,
    irradiance,
    irradiance_map,
    irradiance_matrix,
    matrix_irradiance,
    polynomial_irradiance,
)
from harmface.reproduce.experiment import Measurement
from harmface.reproduce.synthetic import mesh_of
from harmface.sphere import random_directions
from harmface.viz import basis_figure, show_linear

MAP_ROWS = 64
NORMAL_ROWS = 32
SUNNY = ("clear_sky_sun",)
"""Environments that one small lamp dominates: held to the limits of a single light."""


def three_forms() -> Measurement:
    """Evaluate RH01 eq. 7, 11 and 13 at 10,000 normals under the published probes."""
    normals = random_directions(10_000, 0)
    worst = 0.0
    for name in PUBLISHED_PROBES:
        coefficients = published_probe(name)
        forms = np.stack(
            [
                harmonic_irradiance(coefficients, normals),
                matrix_irradiance(irradiance_matrix(coefficients), normals),
                polynomial_irradiance(coefficients, normals),
            ]
        )
        scale = np.abs(forms).max()
        worst = max(worst, float(np.ptp(forms, axis=0).max() / scale))
    figures = {
        f"The irradiance basis functions A_l Y_lm on {name}, as RH01 figure 4: green above zero, "
        "blue below.": _basis_on(mesh)
        for name, mesh in {"a sphere": mesh_of(sphere()), "a head": mesh_of(mean_head())}.items()
    }
    return Measurement([worst], "The constants of RH01 eq. 12 are used to all digits.", figures)


def _basis_on(mesh: Mesh) -> Figure:
    view = gbuffer(mesh, frame_orthographic(mesh, 160), 2)
    return basis_figure(harmonic_images(view.normals, view.mask.astype(float)), view.mask)


@lru_cache(maxsize=1)
def _maps() -> dict[str, EnvironmentMap]:
    return {
        name: EnvironmentMap.from_image(rasterise(make(), MAP_ROWS))
        for name, make in ENVIRONMENTS.items()
    }


def natural_errors(maps: Mapping[str, EnvironmentMap] | None = None) -> Measurement:
    """Hold nine-coefficient irradiance against brute-force integration in every environment.

    Parameters
    ----------
    maps
        Maps to measure besides the procedural environments, by name.
    """
    grid = layout_named("latlong")
    normals, weights = grid.directions(NORMAL_ROWS), grid.solid_angles(NORMAL_ROWS) / (4 * np.pi)
    degrees = range(7)
    figures: dict[str, Figure] = {}
    rows, curves, worst = [], {}, np.zeros(2)
    for name, environment in {**_maps(), **(maps or {})}.items():
        light = environment.as_distant_light()
        truth = irradiance(normals, light)
        total = light.total()[:, None, None]
        errors = []
        for degree in degrees:
            found = irradiance_map(project(environment, degree, "areas"), "latlong", NORMAL_ROWS)
            error = np.abs(found - truth) / total
            errors.append([(error * weights).sum(axis=(1, 2)).max(), error.max()])
        average, largest = errors[2]
        curves[name] = np.array(errors)
        rows.append(f"{name} {average:.2%} / {largest:.2%}")
        if name not in SUNNY:
            worst = np.maximum(worst, errors[2])
        if name in ("nave", "clear_sky"):
            nine = irradiance_map(project(environment, 2, "areas"), "latlong", NORMAL_ROWS)
            figures[
                f"{name}: irradiance by brute force, by nine coefficients, four times their "
                "difference, as RH01 figure 3."
            ] = _side_by_side(truth, nine)
    figure = Figure(figsize=(7, 3.2))
    axes = figure.add_subplot()
    for name, errors_by_degree in curves.items():
        axes.semilogy(degrees, errors_by_degree[:, 0], "o-", ms=3, lw=1, label=name)
    axes.axhline(0.01, color="0.6", lw=0.8, ls="--")
    axes.set(xlabel="highest degree", ylabel="average error / total intensity")
    axes.legend(frameon=False, fontsize=7, ncols=2)
    figures["Average error against degree."] = figure
    return Measurement(
        worst.tolist(),
        f"Average / largest error: {'; '.join(rows)}. The sky with its sun is held to the limits "
        "of a single light instead (3.1 % / 9.4 %).",
        figures,
    )


def prefilter_speed(rows: int = 64) -> Measurement:
    """Time brute-force prefiltering to a 64 x 64 map against projection and evaluation."""
    environment = _maps()["nave"]
    normals = layout_named("angular").directions(rows)
    light = environment.as_distant_light()

    def brute_force() -> None:
        irradiance(normals, light)

    def nine_coefficients() -> None:
        irradiance_map(project(environment, 2), "angular", rows)

    nine_coefficients()
    slow = min(_seconds(brute_force) for _ in range(2))
    fast = min(_seconds(nine_coefficients) for _ in range(20))
    return Measurement(
        [slow / fast],
        f"A lat-long map of {MAP_ROWS} x {2 * MAP_ROWS} pixels; {slow:.2f} s against "
        f"{1000 * fast:.2f} ms, tables warm, both vectorised.",
    )


def _seconds(call: Callable[[], None]) -> float:
    start = time.perf_counter()
    call()
    return time.perf_counter() - start


def _side_by_side(truth: np.ndarray, nine: np.ndarray) -> Figure:
    figure = Figure(figsize=(11, 2.2))
    scale = truth.max()
    pictures = {
        "brute force": truth / scale,
        "nine coefficients": nine / scale,
        "4 x difference": 4 * np.abs(nine - truth) / scale,
    }
    for number, (name, values) in enumerate(pictures.items(), 1):
        show_linear(figure.add_subplot(1, 3, number), values, name)
    figure.subplots_adjust(wspace=0.04)
    return figure
