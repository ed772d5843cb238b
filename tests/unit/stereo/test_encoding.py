"""Truth both ways: the same images, linear and encoded, 8 bits with noise."""

import numpy as np
import pytest

from harmface.conventions import linear_to_srgb
from harmface.stereo.encoding import looks_gamma_encoded


def photographs(scene, directions, rng, encode, noise=0.005):
    images = scene.images(directions, np.eye(len(directions)))
    noisy = np.clip(images / images.max() + noise * rng.standard_normal(images.shape), 0, 1)
    return np.round(encode(noisy) * 255) / 255


@pytest.mark.parametrize("name", ["hills", "ball"])
@pytest.mark.parametrize("noise", [0.0, 0.01])
def test_encoding_is_noticed_and_linear_images_pass(request, rng, single_lights, name, noise):
    scene = request.getfixturevalue(name)
    # Lights from the side leave more outside rank 4 by attached shadows than the curve does.
    lights = single_lights[:12]
    for encode, expected in (
        (lambda v: v, False),
        (linear_to_srgb, True),
        (lambda v: v ** (1 / 2.2), True),
    ):
        values = photographs(scene, lights, rng, encode, noise)
        assert looks_gamma_encoded(values) is expected
    assert not looks_gamma_encoded(photographs(scene, single_lights, rng, lambda v: v, noise))


def test_highlights_and_exposure_raise_no_alarm(ball, rng, single_lights):
    half = single_lights + np.array([0, 0, 1])
    half /= np.linalg.norm(half, axis=1, keepdims=True)
    shine = np.maximum(half @ ball.normals.T, 0) ** 60
    values = photographs(ball, single_lights, rng, lambda v: v)
    assert not looks_gamma_encoded(values + 0.5 * shine)
    assert not looks_gamma_encoded(values * rng.uniform(0.2, 1, (len(values), 1)))
    # Cast shadows: a tenth of each image is dark.
    assert not looks_gamma_encoded(values * (rng.random(values.shape) > 0.1))


def test_nothing_is_said_of_few_or_exact_images(hills, single_lights):
    lit = np.array(
        [[0, 0, 1.0], [0.1, 0, 1], [0, 0.1, 1], [-0.1, 0, 1], [0, -0.1, 1], [0.1, 0.1, 1]]
    )
    assert not looks_gamma_encoded(linear_to_srgb(hills.images(single_lights[:4], np.eye(4)) / 9))
    assert not looks_gamma_encoded(hills.b.dot(lit.T).T.clip(0))
