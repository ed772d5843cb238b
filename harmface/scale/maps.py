"""Lighting coefficients of many environment maps."""

from collections.abc import Callable, Sequence
from functools import partial
from pathlib import Path

import numpy as np
from threadpoolctl import threadpool_limits

from harmface import checks
from harmface.errors import ArgumentError, FileError
from harmface.io.coefficients import write_coefficients
from harmface.io.folders import MANIFEST, job_folder, write_json
from harmface.light import EnvironmentMap, project
from harmface.scale.stores import HERE, Job, made_of

LoadMap = Callable[[Path], EnvironmentMap]


def project_maps(
    folder: Path, files: Sequence[Path], load: LoadMap, max_degree: int = 2, job: Job = HERE
) -> tuple[list[Path], list[FileError]]:
    """Write the lighting coefficients of many maps, or finish what was stopped.

    Parameters
    ----------
    folder
        Made if missing: a JSON file for each map, and a manifest.
    files
        The maps, of unlike names.
    load
        Reads one; it can be pickled.
    max_degree
        Highest degree of the coefficients.
    job
        How it is done.

    Returns
    -------
    tuple
        The files written, and the errors of the maps left out.

    Raises
    ------
    ArgumentError
        If two maps have one name.
    FileError
        If a map cannot be read, or the folder is another's or cannot be written to.
    """
    checks.degree("max_degree", max_degree)
    named = {folder / f"{path.stem}.json": path.absolute() for path in files}
    if len(named) < len(files) or folder / MANIFEST in named:
        raise ArgumentError("files must have names of their own, other than manifest; rename some")
    request = {"max_degree": max_degree, "made": made_of(files)}
    with job_folder(folder, request):
        missing = {out: path for out, path in named.items() if not out.exists()}
        made, skipped = job.usable(
            partial(_written, folder.absolute(), load, max_degree), missing, 1.0
        )
        kept = [out for out in named if out in made or out not in missing]
        maps = {out.name: named[out].name for out in kept}
        write_json(folder / MANIFEST, {"request": request, "maps": maps})
    return kept, skipped


def _written(folder: Path, load: LoadMap, max_degree: int, path: Path) -> None:
    # Sums of one thread have one order, so the bytes do not depend on the number of cores.
    with threadpool_limits(1):
        coefficients = np.atleast_2d(project(load(path), max_degree))
    write_coefficients(folder / f"{path.stem}.json", coefficients)
