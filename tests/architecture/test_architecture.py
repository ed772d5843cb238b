import ast
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
HEAVY = ("pyvista", "matplotlib", "cv2", "sklearn", "trimesh")


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
    from importlinter.cli import lint_imports

    assert lint_imports(config_filename=str(ROOT / "pyproject.toml"), no_cache=True) == 0


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


def test_the_readme_and_ci_run_the_same_test_command():
    command = (ROOT / ".ci" / "run").read_text().splitlines()[-1]
    assert command in (ROOT / "README.md").read_text()
