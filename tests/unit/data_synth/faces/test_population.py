import numpy as np
import pytest
from scipy.spatial import cKDTree

from data_synth.faces import PARAMETERS, build_head, head, mean_head, sample_identity

SMALL = 5_000
FACE_NOISE = 0.1  # mm, what a good scanner leaves


@pytest.fixture(scope="module", params=[None, 0, 3, 11])
def subject(request):
    return mean_head(SMALL) if request.param is None else head(request.param, n_vertices=SMALL)


def sides(faces):
    return np.concatenate([faces[:, [0, 1]], faces[:, [1, 2]], faces[:, [2, 0]]])


def face_normals(subject):
    a, b, c = np.moveaxis(subject.vertices[subject.faces], 1, 0)
    return np.cross(b - a, c - a)


def test_at_least_forty_documented_parameters():
    assert len(PARAMETERS) >= 40
    assert len({q.name for q in PARAMETERS}) == len(PARAMETERS)
    for q in PARAMETERS:
        assert q.meaning
        assert q.low <= q.mean <= q.high
        assert q.spread >= 0
        assert sum(tie**2 for tie in q.ties) < 1


def test_is_a_manifold_open_only_at_the_neck(subject):
    directed = sides(subject.faces)
    assert len(np.unique(directed, axis=0)) == len(directed)  # no edge twice the same way
    edges, count = np.unique(np.sort(directed, axis=1), axis=0, return_counts=True)
    assert set(count) == {1, 2}
    rim = edges[count == 1]
    ends, degree = np.unique(rim, return_counts=True)
    assert (degree == 2).all()
    assert len(ends) == len(rim)
    assert np.ptp(subject.vertices[ends, 1]) < 20
    assert subject.vertices[ends, 1].max() < subject.vertices[:, 1].min() + 20
    assert len(subject.vertices) - len(edges) + len(subject.faces) == 1  # a disc
    assert len(np.unique(subject.faces)) == len(subject.vertices)


def test_no_degenerate_or_duplicate_faces(subject):
    assert len(np.unique(np.sort(subject.faces, axis=1), axis=0)) == len(subject.faces)
    assert np.linalg.norm(face_normals(subject), axis=1).min() / 2 > 1e-4  # mm²


def test_normals_are_unit_and_those_of_the_surface():
    fine = head(3, n_vertices=20_000)
    np.testing.assert_allclose(np.linalg.norm(fine.normals, axis=1), 1, atol=1e-12)
    flat = face_normals(fine)
    area = np.linalg.norm(flat, axis=1)
    at_vertices = np.zeros_like(fine.normals)
    for corner in range(3):
        np.add.at(at_vertices, fine.faces[:, corner], flat)
    at_vertices /= np.linalg.norm(at_vertices, axis=1, keepdims=True)
    cosine = (at_vertices * fine.normals).sum(axis=1)
    weight = np.bincount(fine.faces.ravel(), np.repeat(area, 3))
    angle = np.degrees(np.arccos(np.clip(cosine, -1, 1)))
    # Facets of 1.5 mm over radii of 5 mm and more lean by a few degrees at most; only lid
    # margins, lips and rims of ears, a hundredth of the area, are sharper than that.
    assert np.average(angle, weights=weight) < 1.5
    assert np.average(angle > 20, weights=weight) < 0.01


def test_normals_point_outward(subject):
    centre = np.array([0.0, 0.0, 0.0])
    away = subject.vertices - centre
    skull = subject.vertices[:, 1] > 40  # convex, and the origin lies inside
    assert ((away * subject.normals).sum(axis=1)[skull] > 0).all()


def test_same_seed_same_bytes():
    one, two = head(5, n_vertices=SMALL), head(5, n_vertices=SMALL)
    for name in ("vertices", "faces", "normals", "albedo", "uvs"):
        assert getattr(one, name).tobytes() == getattr(two, name).tobytes()
    assert one.parameters == two.parameters


def test_other_seed_other_person():
    one, two = head(5, n_vertices=SMALL), head(6, n_vertices=SMALL)
    assert not np.allclose(one.vertices, two.vertices, atol=1.0)


def test_heads_do_not_share_memory():
    one, two = mean_head(SMALL), mean_head(SMALL)
    for name in ("vertices", "faces", "normals", "albedo", "uvs"):
        assert not np.shares_memory(getattr(one, name), getattr(two, name))


def test_same_subject_at_any_resolution():
    coarse, fine = head(4, n_vertices=SMALL), head(4, n_vertices=20_000)
    assert coarse.parameters == fine.parameters
    # Vertices lie on one and the same surface, so that those of the coarse mesh are never
    # farther from one of the fine mesh than its spacing, which is a few millimetres on the
    # back of the head.
    distance, nearest = cKDTree(fine.vertices).query(coarse.vertices)
    assert np.median(distance) < 1.0
    assert distance.max() < 6.0
    offset = ((coarse.vertices - fine.vertices[nearest]) * fine.normals[nearest]).sum(axis=1)
    assert np.sqrt(np.mean(offset**2)) < 0.15


def test_parameters_stay_within_their_limits():
    drawn = np.array([list(sample_identity(s, 2.0).values()) for s in range(300)])
    low, high = (np.array([getattr(q, k) for q in PARAMETERS]) for k in ("low", "high"))
    assert (drawn >= low).all()
    assert (drawn <= high).all()


def test_population_has_the_documented_means_and_spreads():
    count = 1500
    drawn = np.array([list(sample_identity(s).values()) for s in range(count)])
    for k, q in enumerate(PARAMETERS):
        unclipped = q.low <= q.mean - 2.9 * q.spread and q.mean + 2.9 * q.spread <= q.high
        if q.name in ("melanin", "relief_pattern") or not unclipped:
            continue
        # Five standard errors; limits at three spreads cost the spread 1.4 %.
        assert abs(drawn[:, k].mean() - q.mean) < 5 * q.spread / np.sqrt(count), q.name
        assert abs(drawn[:, k].std() / q.spread - 1) < 0.015 + 5 / np.sqrt(2 * count), q.name


def test_traits_tie_parameters_together():
    people = [sample_identity(s) for s in range(800)]
    brow, jaw = (np.array([p[k] for p in people]) for k in ("brow_ridge", "bigonial_breadth"))
    by_name = {q.name: q for q in PARAMETERS}
    expected = np.dot(by_name["brow_ridge"].ties, by_name["bigonial_breadth"].ties)
    assert np.corrcoef(brow, jaw)[0, 1] == pytest.approx(expected, abs=5 / np.sqrt(800))


@pytest.mark.parametrize(
    ("name", "change", "axis", "above"),
    [("vault_height", 8.0, 1, -20), ("head_length", 10.0, 2, 15), ("head_breadth", 10.0, 0, 40)],
)
def test_parameters_are_in_millimetres_of_the_head(name, change, axis, above):
    """A length that can be read off the mesh grows by as much as its parameter."""
    base = mean_head(SMALL)
    other = build_head({name: base.parameters[name] + change}, SMALL)
    rows = base.vertices[:, 1] > above
    extent = [np.ptp(h.vertices[rows, axis]) for h in (base, other)]
    # The hair on top does not grow with the skull below it.
    assert extent[1] - extent[0] == pytest.approx(change, rel=0.1)


def test_means_can_be_measured_on_the_mean_head():
    bald = build_head({"hair_volume": 0.0}, SMALL)
    x, y, z = bald.vertices.T
    measured = {
        "head_length": np.ptp(z[y > 10]),
        "head_breadth": 2 * np.abs(x[y > 25]).max(),
        "vault_height": y.max(),
        "bizygomatic_breadth": 2 * np.abs(x[(np.abs(y + 20) < 12) & (z > 8)]).max(),
        "bigonial_breadth": 2 * np.abs(x[(np.abs(y + 70) < 8) & (z > -10)]).max(),
        "neck_breadth": 2 * np.abs(x[np.abs(y + 140) < 10]).max(),
    }
    for name, length in measured.items():
        # The largest of samples some millimetres apart on a curve of radius 60 mm.
        assert length == pytest.approx(bald.parameters[name], abs=2), name


def test_every_parameter_matters():
    base = mean_head(SMALL)
    for q in PARAMETERS:
        far = max(q.low, q.high, key=lambda limit: abs(limit - q.mean))
        other = build_head({q.name: far}, SMALL)
        moved = np.abs(other.vertices - base.vertices).max()
        recoloured = np.abs(other.albedo - base.albedo).max()
        assert moved > 0.2 or recoloured > 0.02, q.name


def test_faces_the_viewer():
    vertices = mean_head(SMALL).vertices
    tip = vertices[vertices[:, 2].argmax()]
    assert abs(tip[0]) < 3
    assert -45 < tip[1] < -28  # the nose, between eyes and mouth
    assert np.abs(vertices[:, 0].mean()) < 1e-9
    lowest = vertices[vertices[:, 1].argmin()]
    assert lowest[1] < -150  # the neck


def test_scale_zero_makes_clones_of_the_mean_face():
    clone, other = (head(s, identity_scale=0.0, n_vertices=SMALL) for s in (8, 9))
    assert clone.vertices.tobytes() == other.vertices.tobytes()
    assert clone.vertices.tobytes() == mean_head(SMALL).vertices.tobytes()
    assert clone.albedo.tobytes() == mean_head(SMALL).albedo.tobytes()


def test_scale_shrinks_towards_the_mean_face():
    mean = mean_head(SMALL).vertices
    gap = [
        np.sqrt(np.mean((head(8, identity_scale=s, n_vertices=SMALL).vertices - mean) ** 2))
        for s in (0.3, 0.6, 1.0)
    ]
    assert gap[0] < gap[1] < gap[2]
    assert gap[0] / gap[2] == pytest.approx(0.3, abs=0.06)


def test_no_two_subjects_alike():
    """RMS distance of corresponding points of two faces, after the best shift, is no noise."""
    count = 60
    faces = np.stack([head(s, n_vertices=SMALL).vertices for s in range(count)])
    faces = faces[:, (faces.mean(axis=0)[:, 2] > 20) & (faces.mean(axis=0)[:, 1] > -120)]
    faces = (faces - faces.mean(axis=1, keepdims=True)).reshape(count, -1)
    squares = (faces**2).sum(axis=1)
    gap2 = (squares[:, None] + squares - 2 * faces @ faces.T) / (faces.shape[1] / 3)
    assert np.sqrt(gap2[np.triu_indices(count, 1)].min()) > 10 * FACE_NOISE


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (lambda: head(-1), "seed: an integer of at least 0 is required, got -1"),
        (lambda: head(1.5), "seed: an integer of at least 0 is required, got 1.5"),
        (lambda: head(1, identity_scale=2.1), r"identity_scale: a number in \[0, 2\].*got 2.1"),
        (lambda: head(1, identity_scale=float("nan")), "identity_scale: .*got nan"),
        (lambda: mean_head(4_999), "n_vertices: an integer from 5000 to 200000.*got 4999"),
        (lambda: mean_head(200_001), "n_vertices: .*got 200001"),
        (lambda: mean_head(6e3), "n_vertices: .*got 6000.0"),
        (lambda: build_head({"beak": 1.0}), "parameters: names from PARAMETERS.*got 'beak'"),
        (lambda: build_head({"mouth_width": 5.0}), r"parameters\['mouth_width'\]: .* mm .*got 5.0"),
        (lambda: build_head({"melanin": float("nan")}), r"parameters\['melanin'\]: .*got nan"),
    ],
)
def test_refuses_nonsense(call, message):
    with pytest.raises(ValueError, match=message):
        call()
