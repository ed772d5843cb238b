"""Cues to the linear map that images leave open, one file a cue."""

from harmface.stereo.cues.albedo import Albedo
from harmface.stereo.cues.cue import Cue, Rows, cost_of, scale_of
from harmface.stereo.cues.diffuse_maxima import DiffuseMaxima
from harmface.stereo.cues.explained import Explained
from harmface.stereo.cues.facing import Facing
from harmface.stereo.cues.field import StructureField, structure_field
from harmface.stereo.cues.highlights import Highlights
from harmface.stereo.cues.integrability import Integrability
from harmface.stereo.cues.known_directions import KnownDirections
from harmface.stereo.cues.light_metric import LightMetric, anisotropy
from harmface.stereo.cues.measured_normals import MeasuredNormals
from harmface.stereo.cues.rim import Outline, Rim, outline_of
from harmface.stereo.cues.strengths import Strengths
from harmface.stereo.cues.symmetry import Symmetry
from harmface.stereo.cues.typical_shape import TypicalShape

__all__ = [
    "Albedo",
    "Cue",
    "DiffuseMaxima",
    "Explained",
    "Facing",
    "Highlights",
    "Integrability",
    "KnownDirections",
    "LightMetric",
    "MeasuredNormals",
    "Outline",
    "Rim",
    "Rows",
    "Strengths",
    "StructureField",
    "Symmetry",
    "TypicalShape",
    "anisotropy",
    "cost_of",
    "outline_of",
    "scale_of",
    "structure_field",
]
