import hashlib
import io
import zipfile

import numpy as np
import pytest

from harmface.errors import FileError
from harmface.io import read_npz, write_npz

ARRAYS = {"a": np.arange(6.0).reshape(2, 3), "b": np.array(["x", "yz"])}


@pytest.fixture
def path(tmp_path):
    write_npz(tmp_path / "f.npz", "thing", 3, ARRAYS, {"note": ["ü", 1]})
    return tmp_path / "f.npz"


def test_what_is_written_is_read(path):
    arrays, attributes = read_npz(path, "thing", 3)
    assert attributes == {"note": ["ü", 1]}
    assert all(np.array_equal(arrays[name], ARRAYS[name]) for name in ARRAYS)


def test_numpy_alone_can_read_it(path):
    with np.load(path) as archive:
        assert np.array_equal(archive["a"], ARRAYS["a"])


@pytest.mark.parametrize(("kind", "version"), [("other", 3), ("thing", 4)])
def test_another_kind_or_version_is_refused(path, kind, version):
    with pytest.raises(FileError, match=f"{kind} version {version} is needed"):
        read_npz(path, kind, version)


def test_every_flipped_byte_and_every_truncation_is_noticed(path, rng):
    whole = path.read_bytes()
    for position in range(0, len(whole), 2):
        broken = bytearray(whole)
        broken[position] ^= 1 << int(rng.integers(8))
        path.write_bytes(broken)
        with pytest.raises(FileError):
            read_npz(path, "thing", 3)
    for length in range(0, len(whole), 31):
        path.write_bytes(whole[:length])
        with pytest.raises(FileError):
            read_npz(path, "thing", 3)


def test_pickled_objects_are_never_loaded(path, tmp_path):
    with pytest.raises(ValueError, match="Object arrays"):
        write_npz(tmp_path / "g.npz", "thing", 3, {"o": np.array([{}], dtype=object)})
    assert not (tmp_path / "g.npz").exists()


def test_a_plain_archive_is_refused(tmp_path):
    np.savez(tmp_path / "plain.npz", a=np.ones(3))
    with pytest.raises(FileError, match="not a harmface thing"):
        read_npz(tmp_path / "plain.npz", "thing", 3)


def forged(path, members, compression=zipfile.ZIP_DEFLATED):
    """An archive of raw members under a valid digest."""
    buffer = io.BytesIO()
    with zipfile.ZipFile(buffer, "w", compression) as archive:
        for name, content in members.items():
            archive.writestr(name, content)
    body = buffer.getvalue()[:-2]
    digest = b"harmface sha256 " + hashlib.sha256(body).hexdigest().encode()
    path.write_bytes(body + len(digest).to_bytes(2, "little") + digest)


def test_arrays_that_claim_more_than_they_hold_are_refused(tmp_path):
    claim = io.BytesIO()
    header = {"descr": "<f8", "fortran_order": False, "shape": (10**6, 10**7)}
    np.lib.format.write_array_header_1_0(claim, header)
    for content, message in (
        (claim.getvalue(), "does not hold the array it claims"),
        (b"\x93NUMPY\x09\x00", "NPY version is 9"),
        (b"no array", "not a harmface thing"),
    ):
        forged(tmp_path / "f.npz", {"a.npy": content})
        with pytest.raises(FileError, match=message):
            read_npz(tmp_path / "f.npz", "thing", 3)


def array_bytes(array):
    buffer = io.BytesIO()
    np.save(buffer, array)
    return buffer.getvalue()


def test_headers_that_no_parser_survives_are_refused(tmp_path):
    deep = b"\x93NUMPY\x02\x00" + (100_000).to_bytes(4, "little") + b"[" * 100_000
    text = array_bytes(np.array("[" * 100_000))
    for members in ({"a.npy": deep}, {"header.npy": text}, {"header.npy": array_bytes(1.5)}, {}):
        forged(tmp_path / "f.npz", members)
        with pytest.raises(FileError, match="not a harmface thing") as error:
            read_npz(tmp_path / "f.npz", "thing", 3)
        assert len(str(error.value)) < 300 + len(str(tmp_path))


def test_a_small_file_does_not_become_gigabytes(tmp_path):
    """Each array is sound, and all of them together fill more than the limit."""
    part = array_bytes(np.zeros(2**27, np.uint8))
    forged(tmp_path / "f.npz", {f"a{number}.npy": part for number in range(9)})
    assert (tmp_path / "f.npz").stat().st_size < 2e6
    with pytest.raises(FileError, match="arrays take more than 1073741824 bytes"):
        read_npz(tmp_path / "f.npz", "thing", 3)


def test_thousands_of_arrays_and_other_compressions_are_refused(tmp_path):
    part = array_bytes(np.zeros(1))
    forged(tmp_path / "f.npz", {f"a{number}.npy": part for number in range(1001)})
    with pytest.raises(FileError, match="it has 1001 arrays"):
        read_npz(tmp_path / "f.npz", "thing", 3)
    forged(tmp_path / "f.npz", {"a.npy": part}, zipfile.ZIP_LZMA)
    with pytest.raises(FileError, match="another way than by deflate"):
        read_npz(tmp_path / "f.npz", "thing", 3)
