"""Build the documentation, its gallery run anew, into `docs/_build/html`; any warning is an error.

Needs `pip install '.[docs]'` and no network. The tables are made from JSON first.
"""

import os
import subprocess
import sys
from pathlib import Path

from tables import write_tables

ROOT = Path(__file__).parents[1]
DOCS = ROOT / "docs"


def main() -> None:
    """Write the tables, then run Sphinx."""
    write_tables()
    command = ["-m", "sphinx", "-q", "-W", "--keep-going", "-b", "html"]
    target = DOCS / "_build" / "html"
    # Inventories of other projects are left out; threads would only compete with each other.
    environment = {**os.environ, "OPENBLAS_NUM_THREADS": "1", "OMP_NUM_THREADS": "1"}
    built = subprocess.run(
        [sys.executable, *command, str(DOCS), str(target)], cwd=ROOT, env=environment, check=False
    )
    if built.returncode:
        sys.exit(built.returncode)
    print(f"documentation in {target / 'index.html'}")


if __name__ == "__main__":
    main()
