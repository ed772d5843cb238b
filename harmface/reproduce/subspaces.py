"""Claims on the subspaces that images of a diffuse object lie in or near."""

import numpy as np
from matplotlib.figure import Figure

from data_synth.shapes import bumpy_sphere
from harmface.conventions import light_direction, luminance
from harmface.geometry import frame_orthographic, gbuffer
from harmface.light import DistantLight
from harmface.rendering import clamped_cosines, harmonic_images, render
from harmface.reproduce.experiment import Measurement
from harmface.reproduce.synthetic import mesh_of
from harmface.sphere import fibonacci_directions, gauss_legendre


def linear_3d() -> Measurement:
    """Project images without any shadow on the subspace of scaled normals (R05 0.2.2).

    The pixels of a bumpy sphere that no light leaves in attached shadow are kept; the images are
    the oracle's.
    """
    mesh = mesh_of(bumpy_sphere())
    view = gbuffer(mesh, frame_orthographic(mesh, 128))
    directions = np.stack(
        [light_direction(a, e) for a in (-40, -20, 0, 20, 40) for e in (-30, -10, 10, 30)]
    )
    images = render(view, DistantLight(directions, np.eye(len(directions))))
    lit = view.mask & (clamped_cosines(view.normals, directions) > 0).all(axis=0)
    scaled = view.normals[lit].T * luminance(view.albedo[lit])
    basis, _ = np.linalg.qr(scaled.T)
    stack = images[:, lit]
    residual = stack - stack @ basis @ basis.T
    relative = np.linalg.norm(residual, axis=1) / np.linalg.norm(stack, axis=1)
    return Measurement(
        [float(relative.max())],
        f"{len(directions)} single lights, {lit.sum()} pixels of a bumpy sphere that all of them "
        "reach; the largest residual of any image.",
    )


def subspace_energy() -> Measurement:
    """Project images of a white sphere under uniform directional light on the harmonic subspaces.

    The sphere's normals are the nodes of a Gauss-Legendre rule with their weights; the images are
    clamped cosines, from which the share inside the span of harmonics is taken.
    """
    normals = gauss_legendre(80)
    lights = fibonacci_directions(2000)
    root = np.sqrt(normals.weights)
    images = clamped_cosines(normals.directions, lights) * root
    harmonics = harmonic_images(normals.directions, np.ones(len(root)), 6) * root
    total = np.einsum("fp,fp->", images, images)
    shares = []
    for degree in range(7):
        # Degrees 3 and 5 have no image: Lambert's coefficient vanishes there.
        basis, values, _ = np.linalg.svd(harmonics[: (degree + 1) ** 2].T, full_matrices=False)
        basis = basis[:, values > 1e-9 * values[0]]
        shares.append(float(np.sum((images @ basis) ** 2) / total))
    axes = (figure := Figure(figsize=(6, 3))).add_subplot()
    axes.plot(range(7), shares, "o-")
    axes.set(xlabel="highest degree", ylabel="share of energy captured", ylim=(0.3, 1.02))
    for degree, share in list(enumerate(shares))[:3]:
        axes.annotate(f"{share:.3f}", (degree, share), xytext=(6, -12), textcoords="offset points")
    return Measurement(
        [shares[1], shares[2]],
        f"{len(lights)} directional lights spread uniformly, {len(root)} normals; mean kept.",
        {"Energy of a sphere's images inside the harmonic subspaces.": figure},
    )
