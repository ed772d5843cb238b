"""Kill every writing command at random moments: nothing is corrupt, and a rerun ends the same.

Example: python scripts/kill.py --kills 100
"""

import argparse
import os
import sys
import tempfile
from pathlib import Path

# One thread: commands run in forks.
os.environ |= {"OPENBLAS_NUM_THREADS": "1", "OMP_NUM_THREADS": "1", "MPLBACKEND": "Agg"}
sys.path.insert(0, str(Path(__file__).parents[1] / "tests"))

from rich.console import Console
from rich.table import Table


def main() -> None:
    """Print a table of what came of the kills; exits with 1 if anything was lost."""
    from kill.commands import COMMANDS
    from kill.harness import kill_all

    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--kills", type=int, default=100)
    parser.add_argument("--commands", nargs="+", choices=COMMANDS, default=list(COMMANDS))
    options = parser.parse_args()
    console, errors = Console(markup=False), Console(stderr=True)

    def tell(number: int, name: str) -> None:
        # No thread draws this, as the commands are forks.
        if errors.is_terminal:
            errors.print(f"{number + 1} of {options.kills}: {name}".ljust(50), end="\r")

    with tempfile.TemporaryDirectory() as folder:
        found = kill_all(Path(folder), options.kills, options.commands, tell)
    table = Table("command", "kills", "touches of files", "seconds", "failed")
    for name, command in found.items():
        numbers = command.kills, command.touches, f"{command.seconds:.1f}", len(command.failures)
        table.add_row(name, *map(str, numbers))
        for failure in command.failures:
            console.print(f"{name}: {failure}", soft_wrap=True, highlight=False)
    console.print(table)
    sys.exit(any(command.failures for command in found.values()))


if __name__ == "__main__":
    main()
