"""Measure claims and judge them."""

import json
import logging
import platform
import time
from collections.abc import Callable, Iterable, Iterator, Mapping
from concurrent.futures import ProcessPoolExecutor, as_completed
from functools import partial
from importlib.metadata import version
from multiprocessing import get_context
from pathlib import Path

import numpy as np
from threadpoolctl import threadpool_limits

from harmface import checks
from harmface.errors import ArgumentError
from harmface.io import atomic_write, read_environment_map
from harmface.io.atomic import claim as claimed
from harmface.io.folders import make_folder
from harmface.io.parts import Parts, digest
from harmface.light import EnvironmentMap, resample
from harmface.reproduce.claims import Claim, load_claims
from harmface.reproduce.irradiance import MAP_ROWS, natural_errors
from harmface.reproduce.registry import EXPERIMENTS
from harmface.reproduce.report import render_report
from harmface.reproduce.result import Result
from harmface.viz import figure_bytes

LOG = logging.getLogger(__name__)


def reproduce(
    folder: Path,
    only: Iterable[str] = (),
    environments: Iterable[Path] = (),
    progress: Callable[[str], None] = lambda claim: None,
    *,
    jobs: int = 1,
) -> list[Result]:
    """Measure claims and write `report.html`, `results.json` and `times.json`.

    A run that was stopped goes on where it was: what it measured is kept in the folder till the
    report is written. Only `times.json` holds what differs from run to run.

    Parameters
    ----------
    folder
        Made if missing.
    only
        Ids of the claims to measure; all if empty.
    environments
        Lat-long maps that `irradiance-error-natural` is measured on too.
    progress
        Told the id of each claim before it is measured; with several jobs, when it has been.
    jobs
        Claims measured at a time, each in a process of its own if more than 1. Times, and ratios
        of times, are of one process beside others then.

    Returns
    -------
    list of Result
        In the order of the claims asked for.

    Raises
    ------
    ArgumentError
        If there is no claim of an id, or `jobs` is below 1.
    """
    checks.positive_integer("jobs", jobs)
    claims = load_claims()
    wanted = list(dict.fromkeys(only)) or list(claims)
    unknown = [name for name in wanted if name not in claims]
    if unknown:
        raise ArgumentError(f"no claim is called {unknown[0]!r}; there are {', '.join(claims)}")
    maps = {path.name: _reduced(read_environment_map(path)) for path in environments}
    make_folder(folder)
    with claimed(folder):
        radiance = {name: environment.radiance for name, environment in maps.items()}
        parts = Parts(folder, digest("reproduce", radiance))
        kept = {name: _kept(parts, claims[name]) for name in wanted}
        missing = [claims[name] for name, result in kept.items() if result is None]
        for result in _all_measured(missing, maps, jobs, progress):
            _keep(parts, result)
            kept[result.claim.id] = result
        results = [result for result in kept.values() if result is not None]
        times = {
            "measured": time.strftime("%Y-%m-%d %H:%M"),
            "seconds": {result.claim.id: round(result.seconds, 3) for result in results},
        }
        _write(folder / "report.html", render_report(results, _environment()))
        _write(folder / "times.json", json.dumps(times, indent=1) + "\n")
        _write(folder / "results.json", json.dumps(_as_json(results), indent=1) + "\n")
        parts.clear()
    return results


def _all_measured(
    claims: list[Claim],
    maps: Mapping[str, EnvironmentMap],
    jobs: int,
    progress: Callable[[str], None],
) -> Iterator[Result]:
    """Yield the result of each claim as it comes."""
    if jobs == 1 or len(claims) < 2:
        for claim in claims:
            progress(claim.id)
            yield _measured(claim, maps)
        return
    # Forked processes would inherit the locks of this one's threads.
    with ProcessPoolExecutor(min(jobs, len(claims)), get_context("spawn")) as pool:
        waiting = [pool.submit(_measured, claim, maps) for claim in claims]
        try:
            for future in as_completed(waiting):
                result = future.result()
                progress(result.claim.id)
                yield result
        finally:
            pool.shutdown(wait=False, cancel_futures=True)


def _measured(claim: Claim, maps: Mapping[str, EnvironmentMap]) -> Result:
    """Run an experiment, and return what it found."""
    experiment = EXPERIMENTS[claim.id]
    if maps and claim.id == "irradiance-error-natural":
        experiment = partial(natural_errors, maps)
    started = time.perf_counter()
    # The products are small: more threads take longer, and change the order of sums.
    with threadpool_limits(1):
        found = experiment()
    seconds = time.perf_counter() - started
    pictures = {caption: figure_bytes(figure) for caption, figure in found.figures.items()}
    return Result(claim, found.values, found.note, pictures, claim.holds(found.values), seconds)


def _keep(parts: Parts, result: Result) -> None:
    """Keep a result for a run that goes on after this one is stopped."""
    arrays = {
        f"picture {number}": np.frombuffer(picture, np.uint8)
        for number, picture in enumerate(result.pictures.values())
    }
    facts = {"values": result.values, "note": result.note, "seconds": result.seconds}
    parts.save(result.claim.id, arrays, {**facts, "captions": list(result.pictures)})
    LOG.info("measured %s in %.1f s", result.claim.id, result.seconds)


def _kept(parts: Parts, claim: Claim) -> Result | None:
    """Return what a stopped run found for a claim, if it came to that."""
    kept = parts.load(claim.id)
    if kept is None:
        return None
    arrays, facts = kept
    values, note, captions = facts["values"], facts["note"], facts["captions"]
    pictures = {
        caption: arrays[f"picture {number}"].tobytes() for number, caption in enumerate(captions)
    }
    return Result(claim, values, note, pictures, claim.holds(values), facts["seconds"])


def _write(path: Path, text: str) -> None:
    with atomic_write(path) as file:
        file.write(text.encode())


def _reduced(environment: EnvironmentMap) -> EnvironmentMap:
    """Return a map small enough for brute force: cell means, which keep the power."""
    return resample(environment, "latlong", min(environment.height, MAP_ROWS))


def _environment() -> dict[str, str]:
    return {
        "harmface": version("harmface"),
        "numpy": version("numpy"),
        "python": platform.python_version(),
        "system": f"{platform.system()} {platform.machine()}",
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
                "measured": result.values,
                "holds": result.holds,
                "note": result.note,
            }
            for result in results
        ],
    }
