"""Surfaces and how they are seen: meshes, cameras, G-buffers, visibility."""

from harmface.geometry.camera import (
    Camera,
    OrthographicCamera,
    PerspectiveCamera,
    frame_orthographic,
    frame_perspective,
)
from harmface.geometry.gbuffer import GBuffer, gbuffer
from harmface.geometry.mesh import Mesh, vertex_normals
from harmface.geometry.visibility import visible

__all__ = [
    "Camera",
    "GBuffer",
    "Mesh",
    "OrthographicCamera",
    "PerspectiveCamera",
    "frame_orthographic",
    "frame_perspective",
    "gbuffer",
    "vertex_normals",
    "visible",
]
