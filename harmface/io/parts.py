"""What a long job has found so far, kept beside its output until all is there."""

import hashlib
import json
from collections.abc import Mapping
from dataclasses import dataclass
from importlib.metadata import version
from importlib.util import find_spec
from pathlib import Path
from typing import Any

import numpy as np

from harmface.errors import FileError
from harmface.io.atomic import HIDDEN
from harmface.io.npz import read_npz, write_npz

KIND, VERSION = "part", 1
PACKAGES = ("numpy", "scipy", "scikit-image", "scikit-learn", "opencv-contrib-python-headless")


@dataclass(frozen=True)
class Parts:
    """Finished parts of a job in a folder: a run that was stopped goes on where it was.

    Parameters
    ----------
    folder
        The job's own, claimed by the caller.
    key
        Digest of all that the results depend on, see `digest`: parts under another key are of
        another job, and are not used.
    of
        Name of the job's output, if the folder is not the job's own but that of other files too.
    """

    folder: Path
    key: str
    of: str = ""

    def load(self, name: str) -> tuple[dict[str, np.ndarray], dict[str, Any]] | None:
        """Return arrays and facts of a finished part; None if it has to be done."""
        try:
            arrays, found = read_npz(self._path(name), KIND, VERSION)
        except FileError:
            return None
        if found.get("key") != self.key or not isinstance(found.get("facts"), dict):
            return None
        return arrays, found["facts"]

    def save(self, name: str, arrays: Mapping[str, np.ndarray], facts: Mapping[str, Any]) -> None:
        """Keep a finished part; facts are anything JSON can hold."""
        attributes = {"key": self.key, "facts": dict(facts)}
        write_npz(self._path(name), KIND, VERSION, arrays, attributes)

    def clear(self) -> None:
        """Remove all parts, this job's and others': what they are for is there, or out of date."""
        for path in self.folder.glob(f"{self._prefix}*.npz"):
            path.unlink(missing_ok=True)

    def _path(self, name: str) -> Path:
        return self.folder / f"{self._prefix}{_short(name)}.npz"

    @property
    def _prefix(self) -> str:
        return f"{HIDDEN}part-{_short(self.of)}-" if self.of else f"{HIDDEN}part-"


def _short(name: str) -> str:
    return hashlib.sha256(name.encode()).hexdigest()[:16]


def digest(request: Any, arrays: Mapping[str, np.ndarray] | None = None) -> str:
    """Return a digest of a request, arrays, and the code that works on them.

    Parameters
    ----------
    request
        Anything JSON can hold.
    arrays
        Numbers or texts that the results depend on.
    """
    found = hashlib.sha256(json.dumps(request, sort_keys=True).encode())
    for name, array in (arrays or {}).items():
        found.update(f"{name} {array.dtype} {array.shape} ".encode())
        found.update(np.ascontiguousarray(array).tobytes())
    found.update(str({package: version(package) for package in PACKAGES}).encode())
    for package in ("harmface", "data_synth"):
        spec = find_spec(package)
        for folder in (spec and spec.submodule_search_locations) or ():
            for path in sorted(Path(folder).rglob("*")):
                if path.suffix in (".py", ".toml", ".json", ".npz"):
                    found.update(str(path.relative_to(folder)).encode() + path.read_bytes())
    return found.hexdigest()
