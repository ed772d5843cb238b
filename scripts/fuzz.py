"""Read damaged files by the thousand: each must be read or refused by name, quietly and cheaply.

Example: python scripts/fuzz.py --cases 10000 --readers png exr
"""

import argparse
import sys
from pathlib import Path

from rich.console import Console
from rich.table import Table

sys.path.insert(0, str(Path(__file__).parents[1] / "tests"))

from fuzz.harness import fuzz
from fuzz.readers import READERS


def main() -> None:
    """Print a table of what came of the cases, and the failures; exits with 1 if there are any."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--cases", type=int, default=1000, help="of each reader")
    parser.add_argument("--first", type=int, default=0, help="number of the first case")
    parser.add_argument("--readers", nargs="+", choices=READERS, default=list(READERS))
    parser.add_argument("--keep", type=Path, help="folder for the files of cases that fail")
    options = parser.parse_args()
    console = Console(markup=False)
    table = Table("reader", "cases", "read", "refused", "failed", "longest, s", "most memory, MB")
    failures = []
    for name in options.readers:
        tally = fuzz(name, options.first, options.cases, options.keep)
        failed = options.cases - tally.outcomes["read"] - tally.outcomes["refused"]
        counts = options.cases, tally.outcomes["read"], tally.outcomes["refused"], failed
        table.add_row(
            name, *map(str, counts), f"{tally.seconds:.2f}", f"{tally.memory / 2**20:.0f}"
        )
        if failed:
            failures.append(f"{name}\n{tally}")
            console.print(failures[-1], soft_wrap=True, highlight=False)
    console.print(table)
    sys.exit(bool(failures))


if __name__ == "__main__":
    main()
