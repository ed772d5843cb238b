"""Claims on light near by: gradients of its coefficients, and what they are good for."""

import time
from collections.abc import Callable

import numpy as np
from matplotlib.figure import Figure

from data_synth.shapes import sphere
from harmface.geometry import frame_orthographic, vertex_weights
from harmface.light import (
    DiscLight,
    NearLight,
    PointLight,
    PolygonLight,
    Probes,
    SphereLight,
    farthest_points,
)
from harmface.rendering import Scene, probes, ray_cast_probes, sampled_light
from harmface.reproduce.experiment import Measurement
from harmface.reproduce.synthetic import mesh_of
from harmface.sphere import fibonacci_directions

DEGREE = 4
RADIUS = 0.5
"""Of the ball of points that stands for an object; its lamps are 1 to 1.2 from its middle."""

SQUARE = np.array([[-0.5, -0.5, 1.0], [-0.5, 0.5, 1.0], [0.5, 0.5, 1.0], [0.5, -0.5, 1.0]])
ONE = np.array(1.0)
LIGHTS: dict[str, NearLight] = {
    "polygon": PolygonLight(SQUARE, ONE),
    "disc": DiscLight(np.array([0.3, 0.2, 1.0]), np.array([0.0, 0.6, -0.8]), 0.5, ONE),
    "sphere": SphereLight(np.array([0.3, 0.2, 1.0]), 0.4, ONE),
    "point": PointLight(np.array([0.3, 0.2, 1.0]), ONE),
}


def gradient() -> Measurement:
    """Hold the gradients of every kind of lamp against central differences of the fourth order."""
    points, step = 0.3 * fibonacci_directions(40), 2e-3
    worst, notes = 0.0, []
    for name, light in LIGHTS.items():
        found = light.probes(points, DEGREE).gradients
        slopes = []
        for axis in np.eye(3):
            moved = {
                n: light.probes(points + n * step * axis, DEGREE).coefficients
                for n in (-2, -1, 1, 2)
            }
            slopes.append((8 * (moved[1] - moved[-1]) - (moved[2] - moved[-2])) / (12 * step))
        off = float(np.abs(found - np.stack(slopes, -1)).max() / np.abs(found).max())
        worst = max(worst, off)
        notes.append(f"{name} {off:.1e}")
    lamp = Scene((PolygonLight(np.add(SQUARE, (0.07, 0.04, 0.0)), np.ones(1)),))
    exact, cast = probes(lamp, points, DEGREE), ray_cast_probes(lamp, points, DEGREE)
    rms = _relative(cast.gradients, exact.gradients)
    return Measurement(
        [worst],
        f"Largest difference over the largest gradient, 40 points, degree {DEGREE}: "
        f"{'; '.join(notes)}. By cube maps of 6 x 64 x 64 rays as in AKDS04 the gradients of a "
        f"square are off by {rms:.1%}, its coefficients by "
        f"{_relative(cast.coefficients, exact.coefficients):.1%}.",
    )


def gain() -> Measurement:
    """Measure the error of extrapolated light over the distance from the sample, AKDS04 figure 8.

    The truth is brute force, rays to points all over the lamps. Errors are of the red channel, as
    in the paper, without and with a blue lamp that hides a part of the red one.
    """
    red = PolygonLight(np.add(SQUARE, (0.0, 0.0, 0.2)), np.array([1.0, 0.0]))
    blue = DiscLight(np.array([0.3, 0.2, 0.8]), np.array([0.0, 0.0, -1.0]), 0.3, np.array([0.0, 1]))
    scenes = {"no blocker": Scene((red,)), "with a blocker": Scene((red, blue))}
    distances = np.linspace(0.05, RADIUS, 8)
    shells = distances[:, None, None] * fibonacci_directions(48)
    points = shells.reshape(-1, 3)
    places = farthest_points(points, 8)
    values, notes = [], []
    figure = Figure(figsize=(8.5, 3.2))
    for number, (name, scene) in enumerate(scenes.items(), 1):
        truth = sampled_light(scene, points, DEGREE, 1024)[:, 0].reshape(*shells.shape[:2], -1)
        scale = np.sqrt(np.mean(truth**2))
        found = probes(scene, places, DEGREE)
        axes = figure.add_subplot(1, 2, number)
        totals = {}
        for count in (1, 8):
            some = Probes(places[:count], found.coefficients[:count], found.gradients[:count])
            for with_gradient in (False, True):
                light = some.at(points, gradient=with_gradient)[:, 0].reshape(truth.shape)
                curve = np.sqrt(np.mean((light - truth) ** 2, axis=(1, 2))) / scale
                label = f"{count} sample{'s' * (count > 1)}, {'no ' * (not with_gradient)}gradient"
                axes.plot(distances, curve, "-" if with_gradient else "--", label=label)
                totals[count, with_gradient] = float(np.sqrt(np.mean(curve**2)))
        axes.set(xlabel="distance from the middle", ylabel="relative RMS error", title=name)
        axes.legend(frameon=False, fontsize=7)
        values += [totals[1, True] / totals[1, False], totals[8, True] / totals[8, False]]
        each = [
            f"{100 * totals[key]:.1f}" for key in ((1, False), (1, True), (8, False), (8, True))
        ]
        notes.append(f"{name}: {' / '.join(each)} %")
    return Measurement(
        values,
        f"Error of one sample without, with gradient, of eight without, with: {'; '.join(notes)}.",
        {"RMS error of the light of a square lamp at distance 1.2, as AKDS04 figure 8.": figure},
    )


def cost() -> Measurement:
    """Time frames of models of the paper's sizes with light as sampled, and with its gradient."""
    rng = np.random.default_rng(0)
    losses, notes = [], []
    for name, resolution in (("Planck", 112), ("bird", 127), ("tooth", 35)):
        mesh = mesh_of(sphere(resolution))
        view = vertex_weights(mesh, frame_orthographic(mesh, 512))
        received = rng.random((25, len(mesh.vertices)), np.float32)
        light, slopes = rng.random((3, 25), np.float32), rng.random((3, 3, 25), np.float32)
        offsets = mesh.vertices.T.astype(np.float32)

        def plain(received=received, light=light, view=view) -> None:  # type: ignore[no-untyped-def]
            view @ (light @ received).T

        def carried(  # type: ignore[no-untyped-def]
            received=received, light=light, slopes=slopes, offsets=offsets, view=view
        ) -> None:
            changed = (slopes.reshape(9, -1) @ received).reshape(3, 3, -1)
            view @ (light @ received + np.einsum("civ,iv->cv", changed, offsets)).T

        without, with_gradient = _seconds(plain, carried)
        losses.append(100 * (1 - without / with_gradient))
        notes.append(
            f"{name} {len(mesh.vertices):,} vertices {1 / without:.0f} and "
            f"{1 / with_gradient:.0f} a second"
        )
    return Measurement(
        losses,
        f"Frames of 512 x 512 pixels, degree 4, three channels: {'; '.join(notes)}. Theirs ran in "
        "the shader of a graphics card of 2004 that had other work too.",
    )


def near_light_energy() -> Measurement:
    """Integrate the irradiance of a matte sphere under a near lamp against zonal harmonics.

    A lamp at distance `d` from the centre gives `E(c) = (d c - 1) / (d^2 - 2 d c + 1)^(3/2)` where
    the cosine `c` of the angle to it is above 1 / d. Energies are those of RH01's harmonics of
    order 0 in it, over the whole.
    """
    nodes, weights = np.polynomial.legendre.leggauss(200)
    shares = {}
    for distance in (1.5, 2.0, 5.0, 1e4):
        low = 1 / distance
        cosine = (1 + low) / 2 + (1 - low) / 2 * nodes
        irradiance = (distance * cosine - 1) / (distance**2 - 2 * distance * cosine + 1) ** 1.5
        each = weights * (1 - low) / 2
        degree = np.arange(13)
        legendre = np.polynomial.legendre.legvander(cosine, 12)
        coefficients = (irradiance * each) @ legendre
        energy = coefficients**2 * (2 * degree + 1) / 2
        shares[distance] = np.cumsum(energy) / ((irradiance**2) @ each)
    figure = Figure(figsize=(5.5, 3.2))
    axes = figure.add_subplot()
    for distance, curve in shares.items():
        label = "far away" if distance > 100 else f"{distance:g} radii"
        axes.plot(range(13), curve, "o-", ms=3, label=label)
    axes.set(xlabel="highest degree", ylabel="share of energy", ylim=(0, 1.02))
    axes.legend(frameon=False, title="lamp from the centre")
    return Measurement(
        [float(value) for curve in shares.values() for value in curve[1:5]],
        "Near lamps light less than a hemisphere: degree 3, which a distant lamp's irradiance has "
        "none of, holds a fifth of the energy at 1.5 and 2 radii.",
        {"Energy of a sphere's irradiance up to a degree.": figure},
    )


def _relative(found: np.ndarray, truth: np.ndarray) -> float:
    return float(np.sqrt(np.mean((found - truth) ** 2) / np.mean(truth**2)))


def _seconds(*calls: Callable[[], None]) -> list[float]:
    times = np.empty((30, len(calls)))
    for row in times:
        for column, call in enumerate(calls):
            start = time.perf_counter()
            call()
            row[column] = time.perf_counter() - start
    return list(times.min(axis=0))
