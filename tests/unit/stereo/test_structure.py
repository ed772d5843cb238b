"""What images determine, and which light is taken to have made them."""

import numpy as np

from harmface.stereo import angular_errors, image_stack, without_linear_map
from harmface.stereo.light_models import PointLights
from harmface.stereo.structure import Knowledge, cues_of, explain
from tests.unit.stereo.conftest import Quadric, front_lights


def test_one_lamp_an_image_is_one_point(rng, unchecked):
    shape = Quadric((16.0, 12.0, 14.0), size=36)
    values = np.maximum(front_lights(16) @ shape.normals.T, 0)
    values = np.maximum(values + 0.002 * rng.standard_normal(values.shape), 0)
    images = np.zeros((16, *shape.mask.shape))
    images[:, shape.mask] = values / values.mean()
    stack = image_stack(images, shape.mask)
    found, gauge = explain(stack, Knowledge(), rng)
    assert found.model == PointLights(1, ambient=False)
    # Noise of 0.2 % of the brightest; only the map is left open.
    left = angular_errors(without_linear_map(found.b, shape.normals), shape.normals)
    assert np.median(left) < 0.3
    assert np.array_equal(found.numbers(found.b), found.b)
    assert np.allclose(found.mapped(gauge.rows, found.b), found.b @ gauge.rows.T)
    names = {cue.name for cue in cues_of(stack, found, Knowledge())}
    told = {"integrability", "albedo", "facing the camera", "rim", "typical shape", "equal lamps"}
    assert told <= names
    assert "symmetry" not in names
    assert "uniform light" not in names
    assert "symmetry" in {cue.name for cue in cues_of(stack, found, Knowledge(symmetric=True))}
