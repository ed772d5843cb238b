"""Gallery files: the harmonic images of every subject enrolled."""

from pathlib import Path

from harmface.errors import ArgumentError, FileError
from harmface.io.npz import read_npz, write_npz
from harmface.recognition.gallery import Gallery

KIND, VERSION = "gallery", 1


def write_gallery(path: Path | str, gallery: Gallery) -> None:
    """Write a gallery to a versioned NPZ file."""
    write_npz(path, KIND, VERSION, {"images": gallery.images}, {"subjects": list(gallery.subjects)})


def read_gallery(path: Path | str) -> Gallery:
    """Read a gallery that `write_gallery` made.

    Raises
    ------
    FileError
        If the file is missing, of another kind or version, or changed since it was written.
    """
    arrays, attributes = read_npz(path, KIND, VERSION)
    try:
        return Gallery(tuple(map(str, attributes["subjects"])), arrays["images"])
    except (KeyError, TypeError) as error:
        raise FileError(f"{path}: is a gallery without {error}; enroll again") from None
    except ArgumentError as error:
        raise FileError(f"{path}: {error}; enroll again") from None
