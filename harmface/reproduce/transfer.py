"""Claims on precomputed transfer: cast shadows and interreflection."""

from typing import Literal

import numpy as np
from matplotlib.figure import Figure

from data_synth.faces import mean_head
from data_synth.shapes import ellipsoid, half_sphere
from harmface.conventions import luminance
from harmface.geometry import Mesh, frame_orthographic, gbuffer, vertex_weights
from harmface.light import DistantLight
from harmface.pca import empirical_pca
from harmface.reflectance import lambert_coefficients
from harmface.rendering import harmonic_images, reflected, render, transfer
from harmface.reproduce.experiment import Measurement
from harmface.reproduce.synthetic import mesh_of
from harmface.sphere import fibonacci_directions, real_harmonics
from harmface.viz import show_linear

DEGREE = 4


def bowl_mesh(albedo: float) -> Mesh:
    """Return a hemisphere of radius 1 that opens to +z, seen from inside."""
    mesh = mesh_of(half_sphere(48)).flipped().rotated(np.diag([1.0, -1.0, -1.0]))
    return Mesh(mesh.vertices, mesh.faces, mesh.normals, np.full(mesh.vertices.shape, albedo))


def vertex_areas(mesh: Mesh) -> np.ndarray:
    """Return the area that each vertex stands for: a third of its faces'."""
    corners = mesh.vertices[mesh.faces]
    normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    area = np.linalg.norm(normals, axis=1) / 2
    return np.bincount(mesh.faces.ravel(), np.repeat(area / 3, 3), len(mesh.vertices))


def bowl() -> Measurement:
    """Take means over a hemispherical bowl, whose every point sees half of the sky.

    A ray's cosine-weighted share of the opening is 1/2 from everywhere, and each bounce returns
    half of what it leaves: the series of albedo rho sums to 1 / (1 - rho / 2).
    """
    mesh = bowl_mesh(0.5)
    areas = vertex_areas(mesh)
    direct = transfer(mesh, DEGREE)

    def mean(values: np.ndarray) -> np.ndarray:
        return np.asarray(np.average(values, axis=-1, weights=areas))

    found = [float(mean(direct.coefficients[0]))]
    for albedo in (0.5, 1.0):
        bounced = transfer(bowl_mesh(albedo), 0, bounces="all").coefficients[0]
        found.append(float(mean(bounced)))
    zonal = [degree * (degree + 1) for degree in range(1, DEGREE + 1)]
    means = mean(direct.coefficients)
    up = real_harmonics(np.array([0.0, 0.0, 1.0]), DEGREE)[zonal]
    off = means[zonal] - lambert_coefficients(DEGREE)[1:] * up / 2
    error = np.sqrt(np.mean((direct.coefficients[0] / found[0] - 1) ** 2))
    claimed = np.sqrt(np.mean(direct.standard_errors[0] ** 2)) / found[0]
    return Measurement(
        [*found, float(np.abs(off).max())],
        f"{len(mesh.vertices):,} vertices. A single vertex's degree 0 is off by {error:.2%} (root "
        f"mean square), where the sampling's standard error says {claimed:.2%}.",
        {"A head under a white sky: convex, with cast shadows, with bounces.": _head_figure()},
    )


def convex() -> Measurement:
    """Hold the transfer of an ellipsoid against Lambert's coefficients times harmonics."""
    mesh = mesh_of(ellipsoid())
    expected = harmonic_images(mesh.normals, np.ones(len(mesh.normals)), DEGREE)
    bounces: tuple[int | Literal["all"], ...] = (0, "all")
    worst = [
        np.abs(transfer(mesh, DEGREE, bounces=number, samples=512).coefficients - expected).max()
        for number in bounces
    ]
    return Measurement(
        [float(max(worst))],
        f"{len(mesh.vertices):,} vertices, without and with bounces. What a convex surface "
        "receives is known, and only what is hidden is sampled: nothing here.",
    )


def subspaces(size: int = 48, lights: int = 200) -> Measurement:
    """Project a head's images with two bounces, by brute force, on subspaces that know of less.

    The images are under single lamps from all sides that light the face, and under random
    mixtures of lamps; the residual is the share of an image's energy outside the subspace.
    """
    mesh = mesh_of(mean_head())
    view = gbuffer(mesh, frame_orthographic(mesh, size))
    albedo = luminance(view.albedo)
    directions = fibonacci_directions(lights)
    lamps = DistantLight(directions, np.eye(lights))
    direct = render(view, lamps, albedo=albedo, caster=mesh)
    bounced = direct + albedo * reflected(mesh, view, lamps, 2)
    # A few lamps stand out of many: exponentials to the fourth power.
    mixtures = np.random.default_rng(0).exponential(size=(64, lights)) ** 4
    sets = {
        "lamps": bounced[directions[:, 2] > 0],
        "mixed": np.tensordot(mixtures, bounced, 1),
    }
    bases = {"harmonic": harmonic_images(view.normals, albedo, DEGREE)}
    for name, bounces in (("shadows", 0), ("bounces", 2)):
        bases[name] = albedo * transfer(mesh, DEGREE, view=view, bounces=bounces).coefficients
    values, notes = [], []
    for kind, images in sets.items():
        for count in (9, 25):
            shares = []
            for basis in bases.values():
                flat = np.linalg.qr(basis[:count, view.mask].T)[0]
                stack = images[:, view.mask]
                left = stack - (stack @ flat) @ flat.T
                shares.append(float(np.mean((left**2).sum(axis=1) / (stack**2).sum(axis=1))))
            values += shares
            notes.append(f"{kind}, {count}-D: {' / '.join(f'{100 * s:.2f}' for s in shares)} %")
    modes = []
    for name, images in (
        ("attached shadows", render(view, lamps, albedo=albedo)),
        ("cast shadows", direct),
        ("two bounces", bounced),
    ):
        share = np.cumsum(empirical_pca(images, view.mask.astype(float), count=5).fractions)
        modes.append(f"{name} {share[2]:.3f} / {share[4]:.3f}")
    return Measurement(
        values,
        f"Residual energy outside harmonic images, those with cast shadows, those with two bounces "
        f"too: {'; '.join(notes)}. Cumulative variance of 3 / 5 principal components of the same "
        f"head under {lights} lamps all around: {'; '.join(modes)} (EHY95: .90 / .94).",
    )


def _head_figure() -> Figure:
    mesh = mesh_of(mean_head())
    view = gbuffer(mesh, frame_orthographic(mesh, 160))
    weights = vertex_weights(mesh, view.camera)
    open_sky = harmonic_images(mesh.normals, np.ones(len(mesh.normals)), 0)
    received = {
        "convex": open_sky[0],
        "cast shadows": transfer(mesh, 0, samples=1024).coefficients[0],
        "two bounces": transfer(mesh, 0, bounces=2, samples=1024).coefficients[0],
    }
    figure = Figure(figsize=(8, 2.8))
    for number, (name, values) in enumerate(received.items(), 1):
        image = (weights @ values).reshape(view.mask.shape) / open_sky[0, 0]
        show_linear(figure.add_subplot(1, 3, number), image, name)
    figure.subplots_adjust(wspace=0.03)
    return figure
