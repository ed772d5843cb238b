from functools import partial

import numpy as np

from data_synth.faces import head
from harmface.io.parts import Parts
from harmface.recognition import SubjectClassifier
from harmface.rendering import transfer
from harmface.reproduce.synthetic import mesh_of
from harmface.scale import distances_on, kept


def test_transfer_is_the_same_everywhere_and_goes_on(tmp_path, at, monkeypatch):
    monkeypatch.setattr("harmface.rendering.precomputed_transfer.PAIRS", 2**17)
    mesh = mesh_of(head(0, n_vertices=5000))
    assert mesh.rays  # made beforehand, as commands do
    parts = Parts(tmp_path, "key")
    alone = transfer(mesh, 1, bounces=1, samples=64)
    found = transfer(mesh, 1, bounces=1, samples=64, keep=partial(kept, parts, at))
    assert found.coefficients.tobytes() == alone.coefficients.tobytes()
    files = sorted(tmp_path.iterdir())
    assert len(files) == 3
    files[1].unlink()
    before = {path: path.stat().st_mtime_ns for path in tmp_path.iterdir()}
    again = transfer(mesh, 1, bounces=1, samples=64, keep=partial(kept, parts, at))
    assert again.coefficients.tobytes() == alone.coefficients.tobytes()
    assert len(list(tmp_path.iterdir())) == 3
    assert before == {path: path.stat().st_mtime_ns for path in before}


def test_any_method_compares_the_same_everywhere(at, rng):
    images = rng.random((12, 64))
    classifier = SubjectClassifier("local", (8, 8)).fit(images, np.repeat(["a", "b", "c"], 4))
    probes = rng.random((150, 64))
    found = distances_on(at, classifier, probes)
    assert np.allclose(found, classifier.distances(probes), rtol=1e-12)
    assert found.shape == (150, 3)
