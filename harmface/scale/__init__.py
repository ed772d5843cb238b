"""Past one machine: the same work on a Dask cluster, with the same results."""

from harmface.scale.engines import Engine, engine
from harmface.scale.maps import project_maps
from harmface.scale.parts import kept
from harmface.scale.recognition import distances_on, recognize
from harmface.scale.stores import Job, enroll_meshes, enroll_photographs, fill_store, pack_probes

__all__ = [
    "Engine",
    "Job",
    "distances_on",
    "engine",
    "enroll_meshes",
    "enroll_photographs",
    "fill_store",
    "kept",
    "pack_probes",
    "project_maps",
    "recognize",
]
