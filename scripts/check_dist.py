"""Build the wheel and the source archive, and try them in empty environments.

The wheel is tried as the slim install of `docs/install.md` (mathematics, light and rendering
without OpenCV, scikit-learn or VTK), and complete; newer versions of Python must find wheels of all
dependencies. With `--oldest` the complete one takes the oldest dependencies that `pyproject.toml`
allows, and the tests of the rooms, laws and equations are run with them.
"""

import argparse
import re
import subprocess
import sys
import tarfile
import tempfile
import venv
import zipfile
from pathlib import Path

ROOT = Path(__file__).parents[1]
HEAVY = ("cv2", "sklearn", "skimage", "pyvista", "matplotlib", "trimesh", "OpenImageIO", "typer")
NEEDED = (
    "harmface/py.typed",
    "harmface/reproduce/claims.toml",
    "data_synth/__init__.py",
    "LICENSE",
)
TESTED = ("unit", "laws", "equations", "misuse")
"""Tests that are run with the oldest dependencies."""
UV = (sys.executable, "-m", "uv")
OLDEST = ("--resolution", "lowest-direct")
NEWER = ("3.12", "3.13", "3.14")
"""Versions of Python, beside the one in use, for which all dependencies must have wheels."""

SLIM = f"""
import importlib.util
import numpy as np
from data_synth.faces import head
from harmface import geometry, light, pca, rendering, sphere

found = [name for name in {HEAVY!r} if importlib.util.find_spec(name)]
assert not found, f"the slim install is to go without {{found}}"
surface = head(1, n_vertices=5000)
mesh = geometry.Mesh(surface.vertices, surface.faces, surface.normals, surface.albedo)
view = geometry.gbuffer(mesh, geometry.frame_orthographic(mesh, 48))
lamp = light.DistantLight(np.array([[0.0, 0.0, 1.0]]), np.ones(1))
assert rendering.render(view, lamp, albedo=view.albedo[..., 0], caster=mesh).max() > 0
assert rendering.harmonic_images(view.normals, view.albedo[..., 0]).shape == (9, 48, 48)
assert abs(pca.analytic_pca(view.normals).fractions.sum() - 1) < 1e-9
print("slim install: rendered and decomposed")
"""

FULL = """
import harmface
for name in harmface.__all__:
    getattr(harmface, name)
print("complete install:", harmface.__version__, "with every subpackage")
"""


def main() -> None:
    """Build, look into what was built, and try it; exits with 1 at the first fault."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--oldest", action="store_true", help="take the oldest dependencies")
    options = parser.parse_args()
    with tempfile.TemporaryDirectory() as folder:
        target = Path(folder)
        run(sys.executable, "-m", "build", "--outdir", str(target), str(ROOT))
        (wheel,), (source,) = target.glob("*.whl"), target.glob("*.tar.gz")
        look_into(wheel, source)
        if options.oldest:
            python = environment(target / "oldest")
            run(*UV, "pip", "install", "-q", "--python", python, *OLDEST, f"{wheel}[test]")
            # From another folder, so that what is tested is what was installed.
            # What new libraries deprecate in old ones is not for this package to mend.
            quiet = ("-p", "no:cacheprovider", "-W", "default::DeprecationWarning")
            run(
                *(python, "-m", "pytest", "-n", "2", *quiet, "--rootdir", str(ROOT)),
                *("-c", f"{ROOT}/pyproject.toml", *(str(ROOT / "tests" / kind) for kind in TESTED)),
                cwd=target,
            )
            return
        python = environment(target / "slim", "--no-deps", str(wheel))
        run(python, "-m", "pip", "install", "-qq", *slim_requirements())
        run(python, "-c", SLIM, cwd=target)
        python = environment(target / "complete", str(wheel))
        run(python, "-c", FULL, cwd=target)
        program = str(Path(python).with_name("harmface"))
        run(program, "--version", cwd=target)
        for version in NEWER:
            # Nothing is built from source: an archive without a wheel counts as missing.
            wanted = ("--python-version", version, "--only-binary", ":all:", "pyproject.toml")
            run(*UV, "pip", "compile", "-q", "-o", str(target / version), *wanted)
            print(f"Python {version}: wheels of all dependencies")
        run(program, "reproduce", "--only", "energy-by-degree", "--out", "report", cwd=target)
    print("wheel and source archive are sound")


def look_into(wheel: Path, source: Path) -> None:
    """Check that all files that are needed are in both archives, and no tests in the wheel."""
    inside = zipfile.ZipFile(wheel).namelist()
    with tarfile.open(source) as archive:
        packed = {name.partition("/")[2] for name in archive.getnames()}
    missing = [name for name in NEEDED if not any(path.endswith(name) for path in inside)]
    missing += [name for name in (*NEEDED, "README.md", "tests/conftest.py") if name not in packed]
    strange = sorted({path.split("/")[0] for path in inside} - {"harmface", "data_synth"})
    strange = [name for name in strange if not name.endswith(".dist-info")]
    if missing or strange:
        sys.exit(f"archives lack {missing}, and the wheel also installs {strange}")


def environment(folder: Path, *requirements: str) -> str:
    """Make an empty environment with these requirements; return its Python."""
    venv.create(folder, with_pip=True)
    python = str(folder / "bin" / "python")
    if requirements:
        run(python, "-m", "pip", "install", "-qq", *requirements)
    return python


def slim_requirements() -> list[str]:
    """Return what the page on installing lists for the slim install."""
    page = (ROOT / "docs" / "install.md").read_text()
    found = re.search(r"^pip install --no-deps harmface\npip install (.+)$", page, re.MULTILINE)
    if found is None:
        sys.exit("docs/install.md no longer tells the slim install")
    return found[1].split()


def run(*command: str, cwd: Path = ROOT) -> None:
    """Run a command; a fault of it ends this program."""
    done = subprocess.run(command, cwd=cwd, check=False)
    if done.returncode:
        sys.exit(f"{' '.join(command[:6])} ... failed with {done.returncode}")


if __name__ == "__main__":
    main()
