"""Measure claims and judge them."""

import json
import platform
import time
from collections.abc import Callable, Iterable
from functools import partial
from importlib.metadata import version
from pathlib import Path

from threadpoolctl import threadpool_limits

from harmface.errors import ArgumentError, FileError
from harmface.io import atomic_write, read_environment_map
from harmface.light import EnvironmentMap, resample
from harmface.reproduce.claims import load_claims
from harmface.reproduce.irradiance import MAP_ROWS, natural_errors
from harmface.reproduce.registry import EXPERIMENTS
from harmface.reproduce.report import render_report
from harmface.reproduce.result import Result


def reproduce(
    folder: Path,
    only: Iterable[str] = (),
    environments: Iterable[Path] = (),
    progress: Callable[[str], None] = lambda claim: None,
) -> list[Result]:
    """Measure claims and write `report.html` and `results.json`.

    Parameters
    ----------
    folder
        Made if missing.
    only
        Ids of the claims to measure; all if empty.
    environments
        Lat-long maps that `irradiance-error-natural` is measured on too.
    progress
        Told the id of each claim before it is measured.

    Raises
    ------
    ArgumentError
        If there is no claim of an id.
    """
    claims = load_claims()
    wanted = list(dict.fromkeys(only)) or list(claims)
    unknown = [name for name in wanted if name not in claims]
    if unknown:
        raise ArgumentError(f"no claim is called {unknown[0]!r}; there are {', '.join(claims)}")
    maps = {path.name: _reduced(read_environment_map(path)) for path in environments}
    experiments = dict(EXPERIMENTS)
    if maps:
        experiments["irradiance-error-natural"] = partial(natural_errors, maps)
    try:
        folder.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise FileError(f"{folder}: cannot be used as a folder: {error.strerror}") from None
    results = []
    for name in wanted:
        progress(name)
        started = time.perf_counter()
        # The products are small: more threads take longer, and change the order of sums.
        with threadpool_limits(1):
            measurement = experiments[name]()
        holds = claims[name].holds(measurement.values)
        results.append(Result(claims[name], measurement, holds, time.perf_counter() - started))
    with atomic_write(folder / "report.html") as file:
        file.write(render_report(results, _environment()).encode())
    with atomic_write(folder / "results.json") as file:
        file.write(json.dumps(_as_json(results), indent=1).encode() + b"\n")
    return results


def _reduced(environment: EnvironmentMap) -> EnvironmentMap:
    """Return a map small enough for brute force: cell means, which keep the power."""
    return resample(environment, "latlong", min(environment.height, MAP_ROWS))


def _environment() -> dict[str, str]:
    return {
        "harmface": version("harmface"),
        "numpy": version("numpy"),
        "python": platform.python_version(),
        "system": f"{platform.system()} {platform.machine()}",
        "measured": time.strftime("%Y-%m-%d %H:%M"),
    }


def _as_json(results: list[Result]) -> dict[str, object]:
    return {
        "environment": _environment(),
        "results": [
            {
                "id": result.claim.id,
                "source": result.claim.source,
                "kind": result.claim.kind,
                "expected": result.claim.expected,
                "tolerance": result.claim.tolerance if result.claim.kind == "equal" else None,
                "measured": result.measurement.values,
                "holds": result.holds,
                "note": result.measurement.note,
                "seconds": round(result.seconds, 3),
            }
            for result in results
        ],
    }
