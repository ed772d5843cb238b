import numpy as np

from harmface.io.parts import Parts, digest


def test_a_part_is_kept_for_its_own_job_only(tmp_path):
    request, data = {"a": 1}, {"x": np.arange(3.0)}
    parts = Parts(tmp_path, digest(request, data))
    assert parts.load("one") is None
    parts.save("one", {"y": np.ones(2)}, {"f": [0.1, None]})
    arrays, facts = Parts(tmp_path, digest(request, data)).load("one")
    assert facts == {"f": [0.1, None]}
    assert np.array_equal(arrays["y"], np.ones(2))
    assert Parts(tmp_path, digest({"a": 2}, data)).load("one") is None
    assert Parts(tmp_path, digest(request, {"x": np.arange(3.0) + 1})).load("one") is None
    assert parts.load("two") is None


def test_a_damaged_part_is_done_again_and_none_stays(tmp_path):
    parts = Parts(tmp_path, "key")
    parts.save("one", {}, {"f": 1})
    (path,) = tmp_path.iterdir()
    path.write_bytes(path.read_bytes()[:-9])
    assert parts.load("one") is None
    parts.clear()
    assert not list(tmp_path.iterdir())
