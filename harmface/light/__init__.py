"""Light: environment maps, lights with known coefficients, and what is done to coefficients."""

from harmface.light.analytic import (
    add_lights,
    ambient,
    cone,
    directional_lights,
    disc,
    hemisphere,
)
from harmface.light.cube_arrangements import (
    ARRANGEMENTS,
    faces_from_image,
    faces_from_opengl,
    image_from_faces,
)
from harmface.light.disc_light import DiscLight
from harmface.light.distant_light import DistantLight
from harmface.light.editing import animate_coefficient, scale_coefficient, set_coefficient
from harmface.light.environment_map import EnvironmentMap
from harmface.light.frames import transformed
from harmface.light.layouts import LAYOUTS, Layout, layout_named
from harmface.light.near_light import NearLight
from harmface.light.point_light import PointLight
from harmface.light.polygon_light import PolygonLight
from harmface.light.probe_grid import ProbeGrid, ScatteredProbes
from harmface.light.probes import Probes, farthest_points
from harmface.light.projection import project, project_map
from harmface.light.published import PUBLISHED_PROBES, published_probe
from harmface.light.sampling import resample, sample
from harmface.light.sphere_light import SphereLight
from harmface.light.windows import (
    hann_window,
    lanczos_window,
    non_negative_window,
    windowed,
)

__all__ = [
    "ARRANGEMENTS",
    "LAYOUTS",
    "PUBLISHED_PROBES",
    "DiscLight",
    "DistantLight",
    "EnvironmentMap",
    "Layout",
    "NearLight",
    "PointLight",
    "PolygonLight",
    "ProbeGrid",
    "Probes",
    "ScatteredProbes",
    "SphereLight",
    "add_lights",
    "ambient",
    "animate_coefficient",
    "cone",
    "directional_lights",
    "disc",
    "faces_from_image",
    "faces_from_opengl",
    "farthest_points",
    "hann_window",
    "hemisphere",
    "image_from_faces",
    "lanczos_window",
    "layout_named",
    "non_negative_window",
    "project",
    "project_map",
    "published_probe",
    "resample",
    "sample",
    "scale_coefficient",
    "set_coefficient",
    "transformed",
    "windowed",
]
