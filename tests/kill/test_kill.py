import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]

QUICK = (
    *("synth shapes", "synth faces", "basis", "render", "enroll meshes", "enroll photographs"),
    *("recognize", "pca", "envmap irradiance", "envmap convert", "evaluate", "stereo", "reproduce"),
)

CARELESS = """
import secrets, sys
from pathlib import Path
from kill.harness import kill_all

def {name}(words):
    {body}

found = kill_all(Path(sys.argv[1]), {kills}, ["basis"], program={name})
print(*found["basis"].failures, sep="\\n")
"""


def test_killed_commands_leave_nothing_corrupt_and_run_again_to_the_same_bytes():
    kills = str(len(QUICK))
    found = subprocess.run(
        [sys.executable, ROOT / "scripts" / "kill.py", "--kills", kills, "--commands", *QUICK],
        capture_output=True,
        text=True,
        check=False,
    )
    assert found.returncode == 0, found.stdout + found.stderr


@pytest.mark.parametrize(
    ("name", "body", "failure"),
    [
        (
            "in_place",
            "file = open('b.npz', 'w'); file.write('half'); file.flush();"
            "Path('x.json').write_text('1'); file.write('whole'); file.close()",
            "corrupt b.npz",
        ),
        ("at_random", "Path('b.npz').write_bytes(secrets.token_bytes(9))", "b.npz differs"),
        (
            "once",
            "Path('b.npz').exists() and sys.exit(2); Path('b.npz').write_text('');"
            "Path('b.npz').read_text()",
            "the next run exits with 2",
        ),
    ],
    ids=["in place", "at random", "once"],
)
def test_careless_programs_are_noticed(tmp_path, name, body, failure):
    code = CARELESS.format(name=name, body=body, kills=1 if name == "at_random" else 8)
    found = subprocess.run(
        [sys.executable, "-c", code, tmp_path],
        capture_output=True,
        text=True,
        check=True,
        env={"PYTHONPATH": str(ROOT / "tests"), "OPENBLAS_NUM_THREADS": "1", "PATH": ""},
    )
    assert failure in found.stdout
