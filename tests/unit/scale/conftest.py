"""One small cluster for all tests of this room."""

import numpy as np
import pytest

from harmface.io import create_store, open_store, write_image
from harmface.recognition import orthonormal_basis
from harmface.scale import fill_store
from harmface.scale.engines import InProcess

SIDE = 8
SUBJECTS, PROBES = 70, 30


@pytest.fixture(scope="session")
def cluster():
    """A scheduler and two workers, as `--workers 2` makes them."""
    import logging

    from distributed import LocalCluster

    with LocalCluster(
        n_workers=2,
        threads_per_worker=1,
        dashboard_address=":0",
        silence_logs=logging.CRITICAL,
    ) as found:
        yield found


@pytest.fixture(params=["in process", "on Dask"])
def at(request):
    """Each engine in turn."""
    if request.param == "in process":
        yield InProcess()
        return
    from harmface.scale import engine

    with engine(scheduler=request.getfixturevalue("cluster").scheduler_address) as found:
        yield found


def basis(number):
    rng = np.random.default_rng(number)
    return orthonormal_basis(rng.standard_normal((3, SIDE**2)), 3).astype(np.float32)


def probe(number):
    rng = np.random.default_rng([1, number])
    return rng.standard_normal(3) @ basis(2 * number) + 0.02 * rng.standard_normal(SIDE**2)


@pytest.fixture
def stores(tmp_path):
    """A gallery and its probes: number k shows subject 2 k."""
    mask = np.ones((SIDE, SIDE), bool)
    names = [f"s{k:02d}" for k in range(SUBJECTS)]
    gallery = create_store(
        tmp_path / "big.zarr", "gallery", names, mask, (3, mask.size), {"method": "subspace"}
    )
    fill_store(gallery, basis, range(SUBJECTS))
    names = [f"p{k:02d}.png" for k in range(PROBES)]
    probes = create_store(tmp_path / "probes.zarr", "probes", names, mask, (mask.size,), {})
    fill_store(probes, probe, range(PROBES))
    return open_store(gallery.path, "gallery"), open_store(probes.path, "probes")


@pytest.fixture
def photographs(tmp_path, rng):
    """A folder of three photographs each of five subjects."""
    for subject in range(5):
        folder = tmp_path / "people" / f"s{subject}"
        folder.mkdir(parents=True)
        spanning = rng.random((3, SIDE, SIDE))
        for number in range(3):
            image = np.tensordot(rng.random(3), spanning, axes=1) / 3
            write_image(folder / f"{number}.png", image)
    return tmp_path / "people"
