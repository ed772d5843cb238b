import numpy as np
import pytest

from data_synth.faces import head
from harmface.errors import ArgumentError, FileError
from harmface.io import create_store, find_photographs, open_store, read_mesh, write_ply
from harmface.io.stores import missing_chunks
from harmface.recognition import SubjectClassifier, enroll, score_block
from harmface.reproduce.synthetic import mesh_of
from harmface.scale import Job, enroll_meshes, enroll_photographs, fill_store, pack_probes


def contents(folder):
    return {
        str(path.relative_to(folder)): path.read_bytes()
        for path in folder.rglob("*")
        if path.is_file()
    }


@pytest.fixture(scope="module")
def meshes(tmp_path_factory):
    folder = tmp_path_factory.mktemp("meshes")
    for seed in range(3):
        write_ply(folder / f"{seed}.ply", mesh_of(head(seed, n_vertices=5000)))
    return {path.stem: path for path in sorted(folder.iterdir())}


@pytest.mark.parametrize("method", ["9d", "25d", "subspace", "3d"])
def test_meshes_have_the_subspaces_of_the_gallery_in_memory(meshes, tmp_path, method):
    store, skipped = enroll_meshes(tmp_path / "g.zarr", meshes, read_mesh, 16, method)
    gallery = enroll({name: read_mesh(path) for name, path in meshes.items()}, 16)
    model = SubjectClassifier.from_gallery(gallery, method).model_
    assert skipped == []
    assert list(store.names) == list(gallery.names)
    assert np.array_equal(store.mask, gallery.mask)
    assert np.array_equal(store.read(0, 3), model["bases"].astype(np.float32))


def test_every_engine_writes_the_same_bytes(photographs, tmp_path, at):
    one, other = tmp_path / "one.zarr", tmp_path / "other.zarr"
    found = find_photographs(photographs)
    enroll_photographs(one, found, "best")
    told = []
    enroll_photographs(other, found, "best", job=Job(at, told.append))
    assert contents(one) == contents(other)
    assert told == pytest.approx(np.arange(1, 6) / 5)


def test_photographs_are_recognised_as_in_memory(photographs, tmp_path):
    found = find_photographs(photographs)
    gallery, _ = enroll_photographs(tmp_path / "g.zarr", found[::2], "subspace")
    probes, _ = pack_probes(tmp_path / "p.zarr", [each.path for each in found[1::2]], gallery)
    images = [each.path for each in found[1::2]]
    assert list(probes.names) == list(map(str, images))
    from harmface.io import read_photographs

    kept, known = read_photographs(found[::2])
    classifier = SubjectClassifier("subspace").fit(
        known.reshape(len(known), -1), [each.subject for each in kept]
    )
    _, shown = read_photographs(found[1::2])
    far = classifier.distances(shown.reshape(len(shown), -1))
    ranking = score_block(gallery.read(0, 5), probes.read(0, len(images)), 5)
    assert np.array_equal(ranking.subjects, far.argsort(axis=1))
    assert np.allclose(ranking.distances, np.sort(far, axis=1), atol=1e-6)


def test_an_unreadable_photograph_is_named_once(photographs, tmp_path, at):
    (photographs / "s3" / "1.png").write_bytes(b"nothing of use")
    found = find_photographs(photographs)
    with pytest.raises(FileError, match=r"s3/1\.png"):
        enroll_photographs(tmp_path / "g.zarr", found, "subspace", job=Job(at))
    store, skipped = enroll_photographs(
        tmp_path / "h.zarr", found, "subspace", job=Job(at, skip_bad=True)
    )
    assert [str(error).split(":")[0][-8:] for error in skipped] == ["s3/1.png"]
    # As on one machine, all subspaces have the dimension of the subject with fewest photographs.
    assert store.shape == (5, 2, 64)
    files = [each.path for each in found]
    probes, skipped = pack_probes(tmp_path / "p.zarr", files, store, job=Job(at, skip_bad=True))
    assert len(skipped) == 1
    assert len(probes.names) == 14


def test_a_stopped_job_goes_on_and_ends_with_the_same_bytes(photographs, tmp_path):
    found = find_photographs(photographs)
    enroll_photographs(tmp_path / "whole.zarr", found, "subspace")

    def stopping(done):
        if done >= 0.4:
            raise KeyboardInterrupt

    half = tmp_path / "half.zarr"
    with pytest.raises(KeyboardInterrupt):
        enroll_photographs(half, found, "subspace", job=Job(progress=stopping))
    with pytest.raises(FileError, match="is half written; give the command"):
        open_store(half, "gallery")
    told = []
    enroll_photographs(half, found, "subspace", job=Job(progress=told.append))
    assert len(told) == 3
    assert contents(half) == contents(tmp_path / "whole.zarr")
    enroll_photographs(half, found, "subspace")
    assert contents(half) == contents(tmp_path / "whole.zarr")
    with pytest.raises(FileError, match="holds something else"):
        enroll_photographs(half, found[:-1], "subspace")


def test_a_foreign_folder_is_left_alone(photographs, tmp_path):
    (tmp_path / "mine").mkdir()
    (tmp_path / "mine" / "diary").write_text("x")
    with pytest.raises(FileError, match="holds something else"):
        enroll_photographs(tmp_path / "mine", find_photographs(photographs), "subspace")


def test_a_full_disk_is_named_and_work_goes_on_from_there(stores, monkeypatch):
    import zarr

    gallery, _ = stores
    (gallery.path / "images" / "c" / "4" / "0" / "0").unlink()

    def full(*arguments, **options):
        raise OSError(28, "No space left on device")

    with monkeypatch.context() as patched:
        patched.setattr(zarr.Array, "__setitem__", full)
        with pytest.raises(FileError, match=r"big\.zarr: cannot be written: No space left"):
            fill_store(gallery, lambda number: np.full((3, 64), 1.0), range(70))
    assert missing_chunks(gallery) == [4 * gallery.chunk]


def lose_chunk(path):
    (path / "images" / "c" / "0" / "0" / "0").unlink()


def cut_chunk(path):
    chunk = path / "images" / "c" / "0" / "0" / "0"
    chunk.write_bytes(chunk.read_bytes()[:-9])


def change(name, old, new):
    def changed(path):
        text = (path / name).read_text()
        assert old in text
        (path / name).write_text(text.replace(old, new))

    return changed


def flip_name(path):
    chunk = path / "names" / "c" / "0" / "0"
    data = bytearray(chunk.read_bytes())
    data[1] ^= 1
    chunk.write_bytes(data)


@pytest.mark.parametrize(
    ("harm", "message"),
    [
        (lose_chunk, "lacks the images from number 0"),
        (cut_chunk, "is damaged"),
        (flip_name, "is no store of use"),
        (change("zarr.json", '"subspace"', '"9d"'), "its seal does not match"),
        (change("zarr.json", '"kind": "gallery"', '"kind": "probes"'), "holds probes version 1"),
        (change("zarr.json", '"facts"', '"fact"'), "it has no 'facts'"),
        (change("zarr.json", "{", "["), "is no store"),
        (change("images/zarr.json", "float32", "int32"), "is no store of use"),
        (change("images/zarr.json", "    70,", "    71,"), "do not belong together"),
        (change("images/zarr.json", "      2,", "      200000000,"), "more than 268435456 bytes"),
        (change("images/zarr.json", "      3,", "      2,"), "its images are cut"),
        (lambda path: (path / "names" / "zarr.json").unlink(), "is no store"),
    ],
    ids=range(12),
)
def test_what_is_damaged_is_refused_in_a_line(stores, harm, message):
    harm(stores[0].path)
    with pytest.raises(FileError, match=message) as found:
        open_store(stores[0].path, "gallery")
    assert "big.zarr" in str(found.value)


def test_other_nonsense_is_refused(tmp_path, photographs, meshes):
    with pytest.raises(FileError, match="is no store"):
        open_store(tmp_path / "none.zarr", "gallery")
    with pytest.raises(ArgumentError, match="a subspace of each subject"):
        enroll_meshes(tmp_path / "g.zarr", meshes, read_mesh, 16, "relit+subspace")
    with pytest.raises(ArgumentError, match="must have meshes"):
        enroll_photographs(tmp_path / "g.zarr", find_photographs(photographs), "9d")
    with pytest.raises(ArgumentError, match="at least one entry"):
        create_store(tmp_path / "g.zarr", "gallery", [], np.ones((2, 2), bool), (4,), {})
    assert not (tmp_path / "g.zarr").exists()
