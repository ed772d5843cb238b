"""`harmface nearlight`: a mesh under lamps near by, by a few probes and their gradients."""

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import numpy as np
import typer

from harmface import checks
from harmface.cli.common import SizeOption, claim_outputs, output, progress
from harmface.cli.mesh_options import MeshArgument, MeshReading
from harmface.cli.option_groups import with_options
from harmface.errors import ArgumentError

if TYPE_CHECKING:
    from harmface.geometry import Mesh
    from harmface.rendering import Scene

DEGREE, DIRECTIONS = 4, 1024
MANY = 8
"""Probes of the comparison, as in AKDS04 figure 7."""

CANDIDATES = 120
"""Places, the middle and some vertices, of which those are taken that tell the light at all of them
best."""

BRIGHTEST = 0.95
"""Where exposure puts the 99.5th percentile of the reference, as a share of white."""


@with_options("mesh_reading", MeshReading)
def nearlight(
    mesh: MeshArgument,
    scene: Annotated[Path, typer.Option(help="TOML file of lamps, see `harmface synth scene`.")],
    out: Annotated[Path, typer.Option(help="PNG file to write.")],
    samples: Annotated[
        int,
        typer.Option(help="Points that the light is taken from: of many, those that err least."),
    ] = 1,
    gradient: Annotated[
        bool, typer.Option(help="Carry samples to other points by their gradients.")
    ] = True,
    exponent: Annotated[
        float, typer.Option(help="Of the distance, in the weights of several samples.")
    ] = 4.0,
    size: SizeOption = 256,
    figure: Annotated[
        Path | None,
        typer.Option(
            help="PNG: one and eight samples, with and without gradients, beside light sampled at "
            "every vertex."
        ),
    ] = None,
    *,
    mesh_reading: MeshReading,
) -> None:
    """Render a mesh under lamps near by from the light at a few points of it (AKDS04).

    The mesh shadows itself; it neither shadows the lamps nor reflects to itself.

    Example: harmface synth scene --out scene.toml
    Example: harmface nearlight head.glb --scene scene.toml --figure near.png --out image.png
    """
    from harmface.geometry import frame_orthographic, gbuffer, vertex_weights
    from harmface.io import read_scene, write_image
    from harmface.rendering import box_average, probes, sampled_light, transfer

    checks.positive_integer("--samples", samples)
    if not exponent > 0:
        raise ArgumentError(f"--exponent must be above 0, got {exponent}")
    claim_outputs(out, figure, inputs=[*mesh_reading.files(mesh), scene])
    surface = mesh_reading.load(mesh)
    lamps = read_scene(scene, surface)
    _check_apart(surface, lamps)
    # Vertices as they come: where there are many the light matters most.
    step = max(1, len(surface.vertices) // max(CANDIDATES, samples))
    places = np.vstack([surface.vertices.mean(axis=0), surface.vertices[::step]])
    found = probes(lamps, places, DEGREE)
    with progress("casting shadows") as report:
        received = transfer(surface, DEGREE, samples=DIRECTIONS, progress=report).coefficients
    view = gbuffer(surface, frame_orthographic(surface, 2 * size))
    weights = vertex_weights(surface, view.camera)

    def image(light: np.ndarray) -> np.ndarray:
        radiosity = np.einsum("vck,kv->vc", light, received)
        pixels = np.maximum(weights @ radiosity, 0).reshape(*view.mask.shape, 3)
        return box_average(np.moveaxis(pixels * view.albedo, -1, 0), 2)

    def approximate(count: int, with_gradient: bool) -> np.ndarray:
        some = found.thinned(count, exponent=exponent)
        return some.at(surface.vertices, gradient=with_gradient, exponent=exponent)

    wanted = image(approximate(samples, gradient))
    exposure = BRIGHTEST / max(float(np.percentile(wanted, 99.5)), np.finfo(float).tiny)
    if figure is not None:
        from harmface.viz import near_light_figure, write_figure

        with progress("sampling the light at every vertex") as report:
            truth = sampled_light(lamps, surface.vertices, DEGREE, progress=report)
        panels, errors = {}, {}
        for count in (1, MANY):
            for with_gradient in (False, True):
                label = (
                    f"{count} sample{'s' * (count > 1)}, {'' if with_gradient else 'no '}gradient"
                )
                light = approximate(count, with_gradient)
                panels[label] = image(light)
                errors[label] = relative_error(light, truth)
        panels["every vertex sampled"] = image(truth)
        write_figure(figure, near_light_figure(panels, errors))
        for label, error in errors.items():
            output.print(f"{label}: error of the light at the vertices {error:.1%}")
    write_image(out, np.moveaxis(wanted * exposure, 0, -1), bits=8, srgb=True)
    output.print(f"{size} x {size} pixels in {out} (sRGB, exposure {exposure:.4g})")


def relative_error(light: np.ndarray, truth: np.ndarray) -> float:
    """Return the root mean square error of coefficients over that of the truth."""
    return float(np.sqrt(np.mean((light - truth) ** 2) / np.mean(truth**2)))


def _check_apart(surface: "Mesh", scene: "Scene") -> None:
    """Refuse lamps that stand in the mesh: no expansion about a point inside holds there."""
    low, high = surface.bounds
    for each in scene.solid:
        inside = ((each.vertices > low) & (each.vertices < high)).all(axis=1)
        if inside.any() and each.radiance.any():
            raise ArgumentError(
                "a lamp of the scene reaches into the mesh's bounding box, where light cannot be "
                "carried from point to point; move it away"
            )
