"""Surfaces and how they are seen: meshes, cameras, G-buffers, visibility."""

from harmface.geometry.camera import (
    Camera,
    OrthographicCamera,
    PerspectiveCamera,
    frame_orthographic,
    frame_perspective,
)
from harmface.geometry.depth_frankot_chellappa import depth_frankot_chellappa
from harmface.geometry.depth_least_squares import depth_least_squares
from harmface.geometry.gbuffer import GBuffer, gbuffer
from harmface.geometry.mesh import Mesh, vertex_normals
from harmface.geometry.slopes import facing_camera
from harmface.geometry.surface_mesh import depth_to_mesh, pixel_coordinates
from harmface.geometry.visibility import visible

__all__ = [
    "Camera",
    "GBuffer",
    "Mesh",
    "OrthographicCamera",
    "PerspectiveCamera",
    "depth_frankot_chellappa",
    "depth_least_squares",
    "depth_to_mesh",
    "facing_camera",
    "frame_orthographic",
    "frame_perspective",
    "gbuffer",
    "pixel_coordinates",
    "vertex_normals",
    "visible",
]
