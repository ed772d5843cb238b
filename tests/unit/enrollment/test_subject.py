import numpy as np
import pytest

from harmface.enrollment import RelitSubject
from harmface.errors import ArgumentError
from harmface.geometry import gbuffer
from harmface.recognition.nine_points import nine_points
from harmface.rendering import harmonic_images


@pytest.fixture
def subject(hill):
    return RelitSubject(hill(1.0).depth, hill(1.0).albedo)


def test_photographs_are_those_of_the_surface(hill, subject, around):
    lights = around(40.0)
    seen, truth = subject.photographs(lights), hill(1.0).images(lights)
    # Normals of a mesh with a vertex a pixel, against exact ones.
    assert np.abs(seen - truth)[:, 1:-1, 1:-1].max() < 0.02


@pytest.fixture
def step():
    """A white floor, and to the right of it a white terrace 5 pixels higher."""
    depth = np.zeros((20, 20))
    depth[:, 10:] = 5.0
    return RelitSubject(depth, np.ones((20, 20)))


def test_a_terrace_casts_its_shadow(step):
    turned = np.radians(45)
    seen = step.photographs(np.array([[np.sin(turned), 0.0, np.cos(turned)]]))[0]
    # The edge stands at column 10; at 45 degrees its shadow is as long as it is high.
    assert (seen[1:-1, 6:9] == 0).all()
    assert np.allclose(seen[1:-1, 1:5], np.cos(turned))


def test_the_view_is_what_a_camera_sees_of_the_mesh(subject):
    view, seen = subject.view, gbuffer(subject.mesh, subject.view.camera)
    within = (slice(1, -1), slice(1, -1))
    # Embree works in single precision.
    assert np.allclose(view.position[within], seen.position[within], atol=1e-4)
    assert np.allclose(view.depth[within], seen.depth[within], atol=1e-4)
    assert np.allclose(view.normals[within], seen.normals[within], atol=1e-4)


def test_harmonic_images_are_those_of_the_normals(subject):
    expected = harmonic_images(subject.normals, subject.albedo)
    assert np.array_equal(subject.harmonic_images(), expected)


def test_cast_shadows_take_light_from_harmonic_images(step):
    free, shadowed = step.harmonic_images(0)[0], step.harmonic_images(0, cast_shadows=True)[0]
    floor, near = (10, 1), (10, 7)
    # From 3 pixels away the edge hides the sky to 59 degrees above the floor.
    assert shadowed[near] < 0.8 * free[near]
    # The mean of 770 directions, and a terrace that is 9 pixels away.
    assert np.isclose(shadowed[floor], free[floor], rtol=0.1)


def test_light_from_behind_leaves_the_front_dark(subject):
    assert not subject.photographs(np.array([[0.0, 0.0, -1.0]])).any()
    assert subject.photographs(nine_points()).any(axis=(1, 2)).all()


def test_nonsense_is_refused(hill, unchecked):
    depth = hill(1.0).depth
    with pytest.raises(ArgumentError, match="albedo must have the depth's size"):
        RelitSubject(depth, np.ones((2, 2)))
    with pytest.raises(ArgumentError, match="albedo"):
        RelitSubject(depth, -np.ones_like(depth))
    with pytest.raises(ArgumentError, match="depth"):
        RelitSubject(np.full_like(depth, np.nan), np.ones_like(depth))
