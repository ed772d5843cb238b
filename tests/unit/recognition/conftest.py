import pytest

from data_synth.faces import head
from harmface.reproduce.synthetic import mesh_of


@pytest.fixture(scope="session")
def similar_heads():
    """Eight heads that resemble each other, by name."""
    return {
        f"subject {seed}": mesh_of(head(seed, n_vertices=5000, identity_scale=0.5))
        for seed in range(8)
    }
