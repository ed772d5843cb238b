from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from harmface.enrollment import from_known_lights, from_stereo, photographs, with_relit
from harmface.errors import ArgumentError
from harmface.recognition import Gallery, Photographs
from harmface.recognition.nine_points import nine_points

NAMES = ("ann", "bob", "cyd")


@pytest.fixture
def gallery(hill, around):
    """Photographs from the front of three hills with knobs, their names and lights."""
    lights = around(10.0)
    images = [hill(knob, seed).images(lights) for seed, knob in enumerate((0.5, 1.0, 1.5))]
    return (
        np.concatenate(images).astype(np.float32),
        np.repeat(NAMES, len(lights)),
        np.tile(lights, (3, 1)),
    )


def enrolled(images, names, lights):
    taken = Photographs(names, images)
    return Gallery(taken, taken.everywhere, lights=lights)


def median_angle(found, truth):
    cosines = (found * truth).sum(axis=-1)[1:-1, 1:-1]
    return np.degrees(np.median(np.arccos(np.clip(cosines, -1, 1))))


def test_surfaces_are_found_from_the_front(gallery, hill):
    found = from_known_lights(*gallery)
    assert tuple(found) == NAMES
    for name, knob in zip(NAMES, (0.5, 1.0, 1.5), strict=True):
        # The hill leans by 30 degrees at most: a start without relief would be off by 20.
        assert median_angle(found[name].normals, hill(knob).normals) < 1


def test_albedo_is_that_of_the_surface(gallery, hill):
    found = from_known_lights(*gallery)["bob"].albedo
    assert np.allclose(found[1:-1, 1:-1], hill(1.0, 1).albedo[1:-1, 1:-1], rtol=0.03)


def test_photographs_not_taken_are_those_that_would_have_been(gallery, hill):
    made = with_relit(enrolled(*gallery))
    assert np.array_equal(made.photographs.images, gallery[0])
    assert made.relit.images.dtype == np.float32
    assert made.relit.subjects.tolist() == np.repeat(NAMES, 8).tolist()
    truth = np.minimum(hill(1.0, 1).images(nine_points()[1:]), gallery[0].max())
    made, flat = made.relit.images[8:16], gallery[0][7:8]
    within = (slice(None), slice(1, -1), slice(1, -1))
    error = np.abs(made - truth)[within].mean()
    assert error < 0.1 * np.abs(flat - truth)[within].mean()


def test_rendered_photographs_saturate_as_the_camera_does(hill, around):
    gentle = hill(1.0)
    # Seen from the front a bright flank is dim; light from aside would make it brighter than all.
    albedo = np.where(gentle.depth < gentle.depth.max() / 2, 0.9, 0.2)
    steep = replace(gentle, depth=4 * gentle.depth, slopes=4 * gentle.slopes, albedo=albedo)
    taken = steep.images(around(10.0))
    gallery = enrolled(taken, np.full(7, "ann"), around(10.0))
    subject = from_known_lights(taken, np.full(7, "ann"), around(10.0))["ann"]
    assert subject.photographs(nine_points()).max() > 1.1 * taken.max()
    assert with_relit(gallery).relit.images.max() == taken.max()


def test_the_order_of_the_photographs_plays_no_part(gallery, rng):
    images, names, lights = gallery
    order = rng.permutation(len(images))
    one = from_known_lights(images, names, lights)["cyd"]
    other = from_known_lights(images[order], names[order], lights[order])["cyd"]
    # Sums in another order, through five solutions of a system of condition 1e6.
    assert np.allclose(one.depth, other.depth, atol=1e-6)


def test_one_subject_alone_under_known_light(gallery, hill):
    images, names, lights = gallery
    alone = from_stereo(images[names == "bob"], lights[names == "bob"])
    assert median_angle(alone.normals, hill(1.0).normals) < 2


def test_one_subject_under_unknown_light(hill, around):
    lights = np.concatenate([around(25.0), around(50.0)[1:], around(70.0)[1:]])
    subject = hill(0.0)
    images = subject.images(lights)
    found = from_stereo(images)
    assert median_angle(found.normals, subject.normals) < 6
    rendered = found.photographs(np.array([[0.0, 0.0, 1.0]]))[0]
    assert np.isclose(np.percentile(rendered, 95), np.percentile(images, 95), rtol=0.02)


@pytest.mark.parametrize(
    ("change", "message"),
    [
        (
            lambda images, names, lights: (images, names[1:], lights),
            "agree in number, got 21, 20 and 21",
        ),
        (lambda images, names, lights: (images, names, 2 * lights), "lights"),
        (
            lambda images, names, lights: (-images, names, lights),
            "photographs must not be negative",
        ),
        (lambda images, names, lights: (images[:, :1], names, lights), "2 x 2 pixels"),
    ],
)
def test_nonsense_is_refused(gallery, change, message, unchecked):
    with pytest.raises(ArgumentError, match=message):
        from_known_lights(*change(*gallery))


def test_nothing_is_rendered_that_was_photographed(hill):
    turn = np.radians(20)
    turned = [[np.cos(turn), 0, np.sin(turn)], [0, 1, 0], [-np.sin(turn), 0, np.cos(turn)]]
    lights = nine_points() @ np.array(turned)
    images = hill(1.0).images(lights)
    made = with_relit(enrolled(images, np.full(9, "ann"), lights))
    assert made.relit.images.shape == (0, *images.shape[1:])


def test_a_normal_that_looks_away_becomes_a_steep_slope(hill, around, monkeypatch):
    lights, subject = around(30.0), hill(1.0)
    normals = subject.normals.copy()
    normals[5, 5] = (0.8, 0.0, -0.6)
    found = SimpleNamespace(normals=normals, albedo=subject.albedo)
    monkeypatch.setattr(photographs, "photometric_stereo", lambda *_, **__: found)
    recovered = from_stereo(subject.images(lights))
    assert np.isfinite(recovered.depth).all()
    assert recovered.depth[5, 4] > recovered.depth[5, 6] + 1


def test_photographs_of_unknown_light_are_refused(gallery):
    with pytest.raises(ArgumentError, match="names that tell the light"):
        with_relit(enrolled(*gallery[:2], None))
