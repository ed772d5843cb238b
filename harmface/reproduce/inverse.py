"""Claims on light from photographs."""

from typing import Any

import numpy as np
from matplotlib.figure import Figure

from data_synth.camera_noise import photograph
from data_synth.environments import ENVIRONMENTS
from data_synth.faces import head
from harmface.conventions import luminance
from harmface.geometry import frame_orthographic, gbuffer
from harmface.inverse import (
    PhotographedSurface,
    estimate_light,
    estimate_light_and_albedo,
    singular_values,
)
from harmface.light import DistantLight
from harmface.rendering import box_average, irradiance, render
from harmface.reproduce.experiment import Measurement
from harmface.reproduce.irradiance import SUNNY
from harmface.reproduce.synthetic import mesh_of, subject_seed
from harmface.sphere import (
    fibonacci_directions,
    gauss_legendre,
    random_directions,
    real_harmonics,
    synthesize,
)

HEADS, LIGHTS, SIZE, SEED = 40, 20, 64, 5
DIRECTIONS = 600
"""Directions of every light, 8 degrees apart; each is a lamp, so that brute force is exact."""


def conditioning() -> Measurement:
    """Measure condition numbers over a sphere, and over what is seen of it from the front.

    Seen orthographically every pixel counts the same, so a normal counts by its part towards the
    viewer: Gauss's rule in it, from 0 to 1, is exact for products of harmonics.
    """
    sphere = gauss_legendre(12)
    nodes, weights = np.polynomial.legendre.leggauss(12)
    z, turns = (nodes + 1) / 2, 2 * np.pi * np.arange(24) / 24
    across = np.sqrt(1 - z**2)[:, None]
    x, y = across * np.cos(turns), across * np.sin(turns)
    front = np.stack([x, y, np.broadcast_to(z[:, None], x.shape)], axis=-1).reshape(-1, 3)
    pixels = np.repeat(weights * z, turns.size)
    spectra = {
        "degree 2, all of a sphere": singular_values(sphere.directions, 2, sphere.weights),
        "degree 1, from the front": singular_values(front, 1, pixels),
        "degree 2, from the front": singular_values(front, 2, pixels),
        "degree 4, from the front": singular_values(front, 4, pixels),
    }
    axes = (figure := Figure(figsize=(6, 3))).add_subplot()
    for name, values in spectra.items():
        axes.semilogy(np.arange(values.size) + 1, values, "o-", ms=3, lw=1, label=name)
    axes.set(xlabel="combination of coefficients", ylabel="singular value (rms)")
    axes.legend(frameon=False, fontsize=7)
    nine = ", ".join(f"{value:.4f}" for value in spectra["degree 2, from the front"])
    return Measurement(
        [float(values[0] / values[-1]) for values in spectra.values()],
        f"Singular values of degree 2 from the front: {nine}. Odd degrees above 1 are left out.",
        {"How well combinations of coefficients are told.": figure},
    )


def odd_degrees(normals: int = 500) -> Measurement:
    """Compare irradiance under lights that differ in degree 3 alone, integrated without harmonics.

    The hemisphere above each normal is integrated by a rule that is exact for the polynomials that
    these radiances are.
    """
    rng = np.random.default_rng(0)
    nodes, weights = np.polynomial.legendre.leggauss(8)
    z, turns = (nodes + 1) / 2, 2 * np.pi * np.arange(16) / 16
    across = np.sqrt(1 - z**2)[:, None]
    local = np.stack(
        np.broadcast_arrays(across * np.cos(turns), across * np.sin(turns), z[:, None]), axis=-1
    ).reshape(-1, 3)
    area = np.repeat(weights / 2 * z, turns.size) * 2 * np.pi / turns.size
    light = np.zeros((2, 16))
    light[:, :9] = 0.2 * rng.standard_normal(9)
    light[:, 0] = 4
    light[1, 9:] = rng.standard_normal(7)
    received = np.empty((2, normals))
    for number, normal in enumerate(random_directions(normals, rng)):
        side = np.linalg.svd(normal[None])[2][1:]
        directions = local @ np.vstack([side, normal])
        received[:, number] = synthesize(light, directions) @ area
    worst = float(np.abs(received[1] - received[0]).max() / received[0].max())
    changed = float(np.linalg.norm(light[1, 9:]) / np.linalg.norm(light[0]))
    return Measurement(
        [worst],
        f"Degree 3 holds {changed:.0%} of the norm of the rest; {normals} normals. So light of "
        "degree 3 cannot be known from a convex matte object (R05 0.4.3).",
    )


def faces(heads: int = HEADS, size: int = SIZE) -> Measurement:
    """Estimate light from photographs of heads whose shape is known, under procedural surroundings.

    Photographs are rendered by brute force, cast shadows included, with camera noise of some 1 %.
    Compared is irradiance on the visible hemisphere; where the albedo is not known one factor is
    free.
    """
    directions = fibonacci_directions(DIRECTIONS)
    lights = _surroundings(directions)
    facing = fibonacci_directions(1000)
    facing = facing[facing[:, 2] > 0]
    truth = irradiance(facing, lights)
    coefficients = lights.irradiances @ real_harmonics(directions, 2).T
    rng = np.random.default_rng(SEED)
    ways = ("known albedo", "constant albedo", "unknown albedo")
    errors = np.empty((3, heads, len(truth)))
    off = np.empty((heads, len(truth), 9))
    for number in range(heads):
        mesh = mesh_of(head(subject_seed(SEED, number)))
        view = gbuffer(mesh, frame_orthographic(mesh, 2 * size))
        images = box_average(render(view, lights, caster=mesh), 2)
        surface = PhotographedSurface.of_mesh(mesh, (size, size))
        assert surface.albedo is not None
        albedo, basis = luminance(surface.albedo), surface.harmonic_irradiances(2)
        known: dict[str, Any] = {"mask": surface.inner, "visibility": basis}
        for which, image in enumerate(images):
            peak = image.max()
            seen = photograph(image[None] / peak, rng=rng, exposure=0.9, bits=12)[0] * peak / 0.9
            found = (
                estimate_light(seen, surface.normals, albedo, **known),
                estimate_light(seen, surface.normals, **known),
                estimate_light_and_albedo(seen, surface.normals, **known)[0],
            )
            for way, each in enumerate(found):
                got = each.irradiance(facing)
                if way:
                    got = got * (got @ truth[which]) / (got @ got)
                errors[way, number, which] = np.abs(got - truth[which]).mean() / truth[which].mean()
            off[number, which] = np.abs(found[0].least_norm - coefficients[which])
            off[number, which] /= coefficients[which, 0]
    medians = np.median(errors, axis=(1, 2))
    axes = (figure := Figure(figsize=(6, 3))).add_subplot()
    constant = medians[1]
    for name, values in zip(ways, errors, strict=True):
        axes.plot(np.sort(values.ravel()), np.linspace(0, 1, values.size), label=name)
    axes.set(xlabel="mean error of irradiance / mean irradiance", ylabel="share", xlim=(0, 0.3))
    axes.legend(frameon=False)
    told = ", ".join(f"{value:.3f}" for value in np.median(off, axis=(0, 1)))
    return Measurement(
        medians[[0, 2]].tolist(),
        f"{heads} heads, {len(truth)} lights, {size} x {size} pixels. As a constant, the albedo "
        f"of hair and lips makes an error of {constant:.1%}. Median error of the nine "
        f"coefficients over L_00, albedo known: {told}.",
        {"Error of the irradiance on the visible hemisphere.": figure},
    )


def _surroundings(directions: np.ndarray) -> DistantLight:
    """Return grey lights: procedural environments without a sun, turned about the vertical."""
    rng = np.random.default_rng(SEED)
    makers = [make for name, make in ENVIRONMENTS.items() if name not in SUNNY]
    lights = []
    for number in range(LIGHTS):
        turn = rng.uniform(0, 2 * np.pi)
        c, s = np.cos(turn), np.sin(turn)
        rotation = np.array([[c, 0, s], [0, 1, 0], [-s, 0, c]])
        radiance = makers[number % len(makers)]().radiance(directions @ rotation)
        lights.append(luminance(radiance) * 4 * np.pi / len(directions))
    return DistantLight(directions, np.stack(lights))
