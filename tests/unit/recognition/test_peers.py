import importlib

import numpy as np
import pytest

from harmface.errors import ArgumentError
from harmface.recognition import SubjectClassifier, peers

ROWS = np.random.default_rng(0).random((4, 24 * 20))


def test_without_its_extra_it_says_what_to_install(monkeypatch):
    def missing(name):
        raise ModuleNotFoundError(name)

    peers._network.cache_clear()
    monkeypatch.setattr(importlib, "import_module", missing)
    with pytest.raises(ArgumentError, match=r"pip install 'harmface\[peers\]'"):
        SubjectClassifier("dlib", (24, 20)).fit(ROWS, list("aabb"))


def test_an_image_is_nearest_to_itself_whatever_the_exposure():
    pytest.importorskip("dlib")
    pytest.importorskip("face_recognition_models")
    peers._network.cache_clear()
    found = SubjectClassifier("dlib", (24, 20)).fit(ROWS, list("abcd")).distances(3 * ROWS)
    assert np.diag(found).max() < 0.5 * found[~np.eye(4, dtype=bool)].min()
