import ast
import importlib
import importlib.metadata
import re
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

import harmface

ROOT = Path(__file__).parents[2]
LIBRARY = [
    path
    for path in [*(ROOT / "harmface").rglob("*.py"), *(ROOT / "data_synth").rglob("*.py")]
    if "cli" not in path.parts
]
HEAVY = ("pyvista", "matplotlib", "cv2", "sklearn", "trimesh", "dask", "distributed", "zarr")


def loaded_after(statement: str) -> set[str]:
    code = f"import sys; {statement}; print(*(m for m in sys.modules if '.' not in m))"
    found = subprocess.run(
        [sys.executable, "-c", code], capture_output=True, text=True, check=True, cwd=ROOT
    )
    return set(found.stdout.split())


def test_importing_the_package_stays_light():
    assert not loaded_after("import harmface") & set(HEAVY)


@pytest.mark.parametrize("name", ["sphere", "reflectance", "geometry", "light", "rendering"])
def test_the_lower_layers_stay_light(name):
    assert not loaded_after(f"import harmface.{name}") & set(HEAVY)


def test_help_needs_no_heavy_library():
    assert not loaded_after("import harmface.cli") & set(HEAVY)


def test_every_subpackage_is_an_attribute():
    folders = [path.parent.name for path in (ROOT / "harmface").glob("*/__init__.py")]
    assert {*folders, "conventions"} - {"cli"} == set(harmface.__all__) & {*folders, "conventions"}
    for name in harmface.__all__:
        assert getattr(harmface, name) is not None
    assert "sphere" in dir(harmface)
    with pytest.raises(AttributeError, match="no attribute 'nothing'"):
        _ = harmface.nothing


@pytest.mark.parametrize("path", LIBRARY, ids=lambda path: str(path.relative_to(ROOT)))
def test_libraries_do_not_print(path):
    calls = [node for node in ast.walk(ast.parse(path.read_text())) if isinstance(node, ast.Call)]
    assert "print" not in {getattr(call.func, "id", "") for call in calls}


def test_the_layers_hold():
    # In a process of its own: it disables all loggers that there are.
    program = Path(sys.executable).parent / "lint-imports"
    found = subprocess.run(
        [program, "--no-cache"], cwd=ROOT, check=False, capture_output=True, text=True
    )
    assert found.returncode == 0, found.stdout


def test_the_readme_does_what_it_shows(tmp_path):
    from data_synth.faces import head
    from data_synth.lightings import mixed
    from harmface.io import write_ply
    from harmface.reproduce.synthetic import mesh_of, probe_images

    meshes = [mesh_of(head(seed, n_vertices=5000)) for seed in (1, 2)]
    write_ply(tmp_path / "head.ply", meshes[0])
    blocks = re.findall(r"```python\n(.*?)```", (ROOT / "README.md").read_text(), re.DOTALL)
    first, second = blocks
    names = {"ann_mesh": meshes[0], "bob_mesh": meshes[1]}
    exec(first.replace("head.glb", str(tmp_path / "head.ply")), names)
    assert names["image"].shape == (256, 256)
    assert names["image"].max() > 0
    rng = np.random.default_rng(0)
    names["photographs"] = probe_images(meshes[1], mixed(2, rng), 64, rng)
    exec(second, names)
    assert list(names["classifier"].predict(names["rows"])) == ["bob", "bob"]


def public_names() -> list[str]:
    """Return every name that a subpackage exports, one a line; a module exports its own."""
    found = []
    for name in sorted({*harmface.__all__, "errors"} - {"HarmfaceError", "__version__"}):
        module = importlib.import_module(f"harmface.{name}")
        exported = getattr(module, "__all__", None) or [
            each
            for each, value in vars(module).items()
            if not each.startswith("_") and getattr(value, "__module__", "") == module.__name__
        ]
        found += [f"{name}.{each}" for each in sorted(exported)]
    return found


def test_public_names_change_only_on_purpose():
    """If one is meant to come or go, change `public_names.txt`, and say so in CHANGELOG.md."""
    kept = (Path(__file__).parent / "public_names.txt").read_text().splitlines()
    found = public_names()
    assert sorted(set(kept) - set(found)) == [], "names that are gone"
    assert sorted(set(found) - set(kept)) == [], "names that are new"


def test_every_public_name_is_in_the_reference():
    pages = {path.stem for path in (ROOT / "docs" / "api").glob("*.rst")}
    assert {name.split(".")[0] for name in public_names()} - {"reproduce"} == pages


def test_the_version_comes_from_one_place():
    assert f"version: {harmface.__version__}" in (ROOT / "CITATION.cff").read_text().splitlines()
    assert f"## [{harmface.__version__}]" in (ROOT / "CHANGELOG.md").read_text()
    assert importlib.metadata.version("harmface") == harmface.__version__
    assert "version =" not in (ROOT / "pyproject.toml").read_text().split("[project.optional")[0]


def test_docstrings_are_held(monkeypatch):
    monkeypatch.syspath_prepend(str(ROOT / "scripts"))
    docstrings = importlib.import_module("docstrings")

    def half_documented(a, b):
        """Return something.

        Parameters
        ----------
        a
            The first.
        """
        if b is None:
            raise ValueError
        return a

    found = docstrings.problems("docstrings.half_documented", half_documented)
    assert [problem.split()[0] for problem in found] == ["PR01", "RT01", "HF01"]
    assert docstrings.problems("harmface.sphere.rotate", harmface.sphere.rotate) == []


def test_the_readme_and_ci_run_the_same_test_command():
    command = (ROOT / ".ci" / "run").read_text().splitlines()[-1]
    assert command in (ROOT / "README.md").read_text()
