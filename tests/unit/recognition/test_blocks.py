import itertools

import array_api_strict
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from threadpoolctl import threadpool_limits

from harmface.errors import ArgumentError
from harmface.recognition import (
    Ranking,
    blocks,
    merge_top,
    orthonormal_basis,
    score_block,
    score_pairs,
    subspace_distances,
)


def world(seed=0, subjects=40, probes=7, pixels=60, dimension=3):
    rng = np.random.default_rng(seed)
    bases = orthonormal_basis(rng.standard_normal((subjects, dimension, pixels)), dimension)
    return bases.astype(np.float32), rng.standard_normal((probes, pixels)).astype(np.float32)


def plain(gallery, probes, top):
    """Return the nearest by what is left of each probe, in float64, one pair at a time."""
    x, q = probes.astype(float), gallery.astype(float)
    x /= np.linalg.norm(x, axis=1, keepdims=True)
    far = np.array([[np.linalg.norm(each - b.T @ (b @ each)) for b in q] for each in x])
    order = far.argsort(axis=1, kind="stable")[:, :top]
    return order, np.take_along_axis(far, order, axis=1)


def same(one, other):
    return (
        one.subjects.tobytes() == other.subjects.tobytes()
        and one.distances.tobytes() == other.distances.tobytes()
    )


def split_scored(gallery, probes, top, cuts):
    edges = [0, *cuts, len(gallery)]
    return [
        score_block(gallery[a:b], probes, top, a) for a, b in itertools.pairwise(edges) if b > a
    ]


def test_the_nearest_are_those_of_a_plain_search():
    gallery, probes = world()
    found = score_block(gallery, probes, 5)
    order, far = plain(gallery, probes, 5)
    assert np.array_equal(found.subjects, order)
    assert np.allclose(found.distances, far, rtol=0, atol=1e-14)
    assert found.distances.dtype == np.float64


def test_they_are_those_of_the_distances_in_memory():
    gallery, probes = world()
    far = subspace_distances(probes, gallery)
    found = score_block(gallery, probes, 5)
    assert np.array_equal(found.subjects, far.argsort(axis=1)[:, :5])
    assert np.allclose(found.distances, np.sort(far, axis=1)[:, :5], atol=1e-6)


def test_small_distances_are_told_apart_where_float32_cannot():
    rng = np.random.default_rng(1)
    base = np.linalg.qr(rng.standard_normal((2000, 9)))[0].T
    # Sixty subjects that differ by less than the rounding of a squared distance in float32.
    tilts = 1e-5 * rng.permutation(np.arange(1, 61)) / 60
    away = rng.standard_normal(2000)
    away -= base.T @ (base @ away)
    away /= np.linalg.norm(away)
    gallery = np.repeat(base[None], 60, axis=0)
    gallery[:, 0] = np.cos(tilts)[:, None] * base[0] + np.sin(tilts)[:, None] * away
    probe = base[:1]
    found = score_block(gallery, probe, 60)
    assert np.array_equal(found.subjects[0], tilts.argsort())
    assert np.allclose(found.distances[0], np.sort(np.sin(tilts)), rtol=1e-9)
    assert np.array_equal(score_block(gallery, probe, 3).subjects[0], tilts.argsort()[:3])
    single = subspace_distances(probe.astype(np.float32), gallery)[0]
    assert not np.array_equal(single.argsort(kind="stable"), tilts.argsort())


@given(seed=st.integers(0, 999), data=st.data())
def test_any_split_in_any_order_gives_the_same_bytes(seed, data):
    gallery, probes = world(seed, subjects=12)
    # Clones, so that there are ties.
    gallery[5:8] = gallery[0]
    cuts = sorted(data.draw(st.lists(st.integers(0, 12), max_size=5)))
    parts = data.draw(st.permutations(split_scored(gallery, probes, 4, cuts)))
    while len(parts) > 1:
        at = data.draw(st.integers(0, len(parts) - 2))
        parts[at : at + 2] = [merge_top(*parts[at : at + 2])]
    assert same(parts[0], score_block(gallery, probes, 4))
    alone = [score_block(gallery, probes[n : n + 1], 4) for n in range(len(probes))]
    assert np.array_equal(np.concatenate([each.distances for each in alone]), parts[0].distances)


@given(seed=st.integers(0, 999))
def test_merging_is_associative_and_commutative(seed):
    rng = np.random.default_rng(seed)

    def ranking(number):
        far = rng.integers(0, 3, (2, 4)).astype(float)
        names = 10 * number + rng.permuted(np.tile(np.arange(4), (2, 1)), axis=1)
        order = np.lexsort((names, far))
        pick = np.take_along_axis
        return Ranking(pick(names, order, 1), pick(far, order, 1))

    a, b, c = map(ranking, range(3))
    assert same(merge_top(a, b), merge_top(b, a))
    assert same(merge_top(merge_top(a, b), c), merge_top(a, merge_top(b, c)))


def test_neither_threads_nor_pieces_change_a_byte(monkeypatch):
    gallery, probes = world(subjects=300, pixels=2500, dimension=9)
    with threadpool_limits(1):
        one = score_block(gallery, probes, 5)
    with threadpool_limits(2):
        assert same(score_block(gallery, probes, 5), one)
    monkeypatch.setattr(blocks, "PRODUCTS", 1000)
    monkeypatch.setattr(blocks, "PAIRS", 1)
    assert same(score_block(gallery, probes, 5), one)


def test_the_product_in_float32_is_within_its_bound():
    gallery, probes = world(subjects=200, probes=50, pixels=3000, dimension=9)
    probes /= np.linalg.norm(probes, axis=1, keepdims=True)
    error = blocks.captured(probes, gallery) - blocks.captured(probes.astype(float), gallery)
    assert np.abs(error).max() < np.sqrt(9 * 3000) * np.finfo(np.float32).eps


@pytest.mark.parametrize("library", ["array_api_strict", "torch"])
def test_other_libraries_find_the_same(library):
    xp = array_api_strict if library == "array_api_strict" else pytest.importorskip("torch")
    gallery, probes = world()
    there = score_block(xp.asarray(gallery), xp.asarray(probes), 5)
    here = score_block(gallery, probes, 5)
    assert np.array_equal(there.subjects, here.subjects)
    assert np.allclose(there.distances, here.distances, rtol=0, atol=1e-14)
    pairs = np.stack([np.repeat(np.arange(7), 5), here.subjects.ravel()])
    some = score_pairs(xp.asarray(gallery), xp.asarray(probes), pairs, 5)
    assert np.array_equal(some.subjects, here.subjects)


def test_where_subjects_are_few_nobody_fills_the_rest():
    gallery, probes = world(subjects=2)
    found = score_block(gallery, probes, 4, first=7)
    assert set(found.subjects[:, :2].ravel()) == {7, 8}
    assert (found.subjects[:, 2:] == blocks.NOBODY).all()
    assert np.isinf(found.distances[:, 2:]).all()


def test_pairs_of_a_ranking_are_scored_alone():
    gallery, probes = world()
    whole = score_block(gallery, probes, 40)
    listed = whole.subjects[:, 10:16]
    pairs = np.stack([np.repeat(np.arange(7), 6), listed.ravel()])
    low = pairs[1] < 25
    found = merge_top(
        score_pairs(gallery[:25], probes, pairs[:, low], 6),
        score_pairs(gallery[25:], probes, pairs[:, ~low], 6, 25),
    )
    assert same(found, Ranking(listed.copy(), whole.distances[:, 10:16].copy()))
    with pytest.raises(ArgumentError, match="subjects from 25 on"):
        score_pairs(gallery[25:], probes, pairs, 6, 25)


def test_nonsense_is_refused():
    gallery, probes = world()
    broken = gallery.copy()
    broken[3, 1, 2] = np.nan
    for bad, message in [
        ((broken, probes, 1), "gallery must be finite"),
        ((gallery, probes * np.inf, 1), "probes must be finite"),
        ((gallery, 0 * probes, 1), "all black"),
        ((gallery, probes[:, :-1], 1), "shape"),
        ((gallery[:0], probes, 1), "hold subjects"),
        ((gallery, probes, 0), "top"),
    ]:
        with pytest.raises(ArgumentError, match=message), np.errstate(invalid="ignore"):
            score_block(*bad)
    with pytest.raises(ArgumentError, match="same probes"):
        merge_top(score_block(gallery, probes, 1), score_block(gallery, probes, 2))
