import numpy as np
import pytest

from data_synth.faces import head
from harmface.conventions import light_direction
from harmface.errors import ArgumentError
from harmface.recognition import Gallery, Photographs, distance_named, enroll, subject_highlights
from harmface.recognition.glossy import GlossyDistance
from harmface.recognition.specular import extended_bases
from harmface.recognition.subspace import orthonormal_basis
from harmface.reproduce.synthetic import mesh_of
from harmface.sphere import real_harmonics

SIZE, SHARE = 32, 0.3


@pytest.fixture(scope="module")
def meshes():
    return {f"{seed}": mesh_of(head(seed, n_vertices=5000)) for seed in range(3)}


@pytest.fixture(scope="module")
def gallery(meshes):
    return enroll(meshes, SIZE, cast_shadows=False)


def test_highlights_from_the_gallery_are_those_of_the_meshes(gallery, meshes):
    """Against specular images that are made of the meshes' own normals."""
    images = np.stack([subject_highlights(mesh, SIZE, 8.0) for mesh in meshes.values()])
    bases = orthonormal_basis(gallery.harmonic[..., gallery.mask], 9)
    expected = extended_bases(bases, images[..., gallery.mask], 1)
    found = distance_named("glossy").fit(gallery)["bases"]
    assert found.shape == (3, 10, gallery.mask.sum())
    assert np.allclose(found[:, :9], expected[:, :9], atol=1e-5)
    along = np.abs(np.einsum("np,np->n", found[:, 9], expected[:, 9]))
    assert along.min() > 0.98


def test_a_shiny_subject_is_nearer_than_without_highlights(gallery, meshes):
    lamp = light_direction(20, 30)
    for number, mesh in enumerate(meshes.values()):
        matte = np.einsum("k,khw->hw", real_harmonics(lamp, 2), gallery.harmonic[number])
        shine = np.einsum("k,khw->hw", real_harmonics(lamp, 6), subject_highlights(mesh, SIZE, 8.0))
        probe = (np.maximum(matte, 0) + SHARE * np.maximum(shine, 0))[None].astype(np.float32)
        glossy, plain = (
            each.distances(each.fit(gallery), probe, gallery.mask)[0]
            for each in (GlossyDistance(), distance_named("9d"))
        )
        assert glossy.argmin() == number
        assert glossy[number] < plain[number]


def test_photographs_tell_no_normals():
    images = np.ones((2, 4, 4), np.float32)
    photographs = Photographs(np.array(["a", "b"]), images)
    gallery = Gallery(photographs, photographs.everywhere)
    with pytest.raises(ArgumentError, match="must hold harmonic images"):
        GlossyDistance().fit(gallery)
