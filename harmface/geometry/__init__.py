"""Surfaces and how they are seen: meshes, cameras, G-buffers, visibility."""

from harmface.geometry.camera import (
    Camera,
    OrthographicCamera,
    PerspectiveCamera,
    frame_orthographic,
    frame_perspective,
)
from harmface.geometry.defects import Defects, mesh_defects
from harmface.geometry.depth_frankot_chellappa import depth_frankot_chellappa
from harmface.geometry.depth_least_squares import depth_least_squares
from harmface.geometry.gbuffer import GBuffer, gbuffer, vertex_weights
from harmface.geometry.mesh import Mesh, vertex_normals
from harmface.geometry.orientation import (
    axis_rotations,
    face_rotation,
    outward_share,
    paints_a_face,
)
from harmface.geometry.slopes import facing_camera
from harmface.geometry.surface_mesh import depth_to_mesh, pixel_coordinates
from harmface.geometry.texture import Texture, TextureImage
from harmface.geometry.two_sided import one_side, same_places
from harmface.geometry.visibility import Blocked, blocked, visible

__all__ = [
    "Blocked",
    "Camera",
    "Defects",
    "GBuffer",
    "Mesh",
    "OrthographicCamera",
    "PerspectiveCamera",
    "Texture",
    "TextureImage",
    "axis_rotations",
    "blocked",
    "depth_frankot_chellappa",
    "depth_least_squares",
    "depth_to_mesh",
    "face_rotation",
    "facing_camera",
    "frame_orthographic",
    "frame_perspective",
    "gbuffer",
    "mesh_defects",
    "one_side",
    "outward_share",
    "paints_a_face",
    "pixel_coordinates",
    "same_places",
    "vertex_normals",
    "vertex_weights",
    "visible",
]
