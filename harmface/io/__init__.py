"""Files: every byte from outside is checked here, every file written is whole or not there."""

from harmface.io.atomic import atomic_write, claim
from harmface.io.captures import Capture, read_capture, read_mask
from harmface.io.coefficients import read_coefficients, write_coefficients
from harmface.io.datasets import Dataset, read_dataset
from harmface.io.environment_maps import (
    file_layout,
    read_environment_map,
    write_environment_map,
)
from harmface.io.films import Frames, read_film
from harmface.io.folders import output_folder, prepare_folder
from harmface.io.galleries import read_gallery, write_gallery
from harmface.io.gallery_choice import choose_gallery
from harmface.io.images import read_image, write_image
from harmface.io.light_files import Lights, read_lights
from harmface.io.measured import read_measured_directions, read_measured_normals
from harmface.io.merl import read_merl
from harmface.io.meshes import read_mesh, write_glb, write_obj, write_ply
from harmface.io.npz import read_npz, write_npz
from harmface.io.photo_sets import Photograph, find_photographs, read_photographs
from harmface.io.pictures import MAX_PIXELS
from harmface.io.pixel_maps import read_albedo_map, read_normal_map
from harmface.io.poses import read_cameras, read_poses, write_poses
from harmface.io.probe_grids import read_probe_grid, write_probe_grid
from harmface.io.scenes import read_scene
from harmface.io.stores import Store, create_store, open_store
from harmface.io.surfaces import (
    MESH_FILES,
    Surface,
    read_surface,
    surface_files,
    write_surface,
)
from harmface.io.tool_coefficients import (
    read_tool_coefficients,
    tool_text,
    write_tool_coefficients,
)
from harmface.io.transfers import read_transfer, write_transfer

__all__ = [
    "MAX_PIXELS",
    "MESH_FILES",
    "Capture",
    "Dataset",
    "Frames",
    "Lights",
    "Photograph",
    "Store",
    "Surface",
    "atomic_write",
    "choose_gallery",
    "claim",
    "create_store",
    "file_layout",
    "find_photographs",
    "open_store",
    "output_folder",
    "prepare_folder",
    "read_albedo_map",
    "read_cameras",
    "read_capture",
    "read_coefficients",
    "read_dataset",
    "read_environment_map",
    "read_film",
    "read_gallery",
    "read_image",
    "read_lights",
    "read_mask",
    "read_measured_directions",
    "read_measured_normals",
    "read_merl",
    "read_mesh",
    "read_normal_map",
    "read_npz",
    "read_photographs",
    "read_poses",
    "read_probe_grid",
    "read_scene",
    "read_surface",
    "read_tool_coefficients",
    "read_transfer",
    "surface_files",
    "tool_text",
    "write_coefficients",
    "write_environment_map",
    "write_gallery",
    "write_glb",
    "write_image",
    "write_npz",
    "write_obj",
    "write_ply",
    "write_poses",
    "write_probe_grid",
    "write_surface",
    "write_tool_coefficients",
    "write_transfer",
]
