"""Run every check: lint, format, types, layers, tests. Stops at the first that fails."""

import subprocess
import sys
from pathlib import Path

ROOT = Path(__file__).parents[1]
CHECKS = (
    ("ruff", "check"),
    ("ruff", "format", "--check"),
    ("mypy",),
    ("lint-imports", "--no-cache"),
    ("pytest", "-n", "2", "--durations", "10"),
)


def main() -> None:
    """Run the checks of the environment that this script runs in."""
    programs = Path(sys.executable).parent
    for name, *arguments in CHECKS:
        print(f"== {name} {' '.join(arguments)}", flush=True)
        found = subprocess.run([programs / name, *arguments], cwd=ROOT, check=False)
        if found.returncode:
            sys.exit(found.returncode)


if __name__ == "__main__":
    main()
