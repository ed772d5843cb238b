"""The energy of images in few dimensions, which the factorisation methods live on ([BJK07])."""

import numpy as np
import pytest

from data_synth.lightings import mixed
from data_synth.shapes import ellipsoid, textured
from harmface.geometry import Mesh, frame_orthographic, gbuffer
from harmface.light import DistantLight
from harmface.rendering import render
from harmface.stereo import factorize


@pytest.fixture(scope="module")
def energy():
    shape = textured(ellipsoid(), "noise")
    mesh = Mesh(shape.vertices, shape.faces, shape.normals, shape.albedo)
    view = gbuffer(mesh, frame_orthographic(mesh, 48))
    lights = mixed(64, 1)
    images = render(view, DistantLight(lights.directions, lights.weights))
    return factorize(images[:, view.mask], 9).energy


def test_rank_four_and_nine_hold_the_images(energy):
    assert energy[3] >= 0.97
    assert energy[8] >= 0.995


def test_three_dimensions_are_not_enough_for_ambient_light(energy):
    assert np.all(np.diff(energy[:9]) > 1e-5)
