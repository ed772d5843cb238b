"""Run every check: lint, format, types, layers, docstrings, tests. Stops at the first failure."""

import os
import subprocess
import sys
from pathlib import Path

ROOT = Path(__file__).parents[1]
CHECKS = (
    ("ruff", "check"),
    ("ruff", "format", "--check"),
    ("mypy",),
    ("lint-imports", "--no-cache"),
    ("python", "scripts/docstrings.py"),
    ("pytest", "-n", "2", "--durations", "10"),
)

# The tests run in as many processes as there are cores; more threads would only get in the way.
ENVIRONMENT = {**os.environ, "OPENBLAS_NUM_THREADS": "1", "OMP_NUM_THREADS": "1"}


def main() -> None:
    """Run the checks of the environment that this script runs in."""
    programs = Path(sys.executable).parent
    for name, *arguments in CHECKS:
        print(f"== {name} {' '.join(arguments)}", flush=True)
        found = subprocess.run(
            [programs / name, *arguments], cwd=ROOT, env=ENVIRONMENT, check=False
        )
        if found.returncode:
            sys.exit(found.returncode)


if __name__ == "__main__":
    main()
