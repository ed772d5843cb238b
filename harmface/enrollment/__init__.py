"""Subjects from photographs: their surfaces, and what they look like in light not photographed."""

from harmface.enrollment.alignment import frame_to_photograph, in_frame, place_sitting
from harmface.enrollment.eyes import dlib_eyes, yunet_eyes
from harmface.enrollment.photographs import from_known_lights, from_stereo, with_relit
from harmface.enrollment.subject import RelitSubject

__all__ = [
    "RelitSubject",
    "dlib_eyes",
    "frame_to_photograph",
    "from_known_lights",
    "from_stereo",
    "in_frame",
    "place_sitting",
    "with_relit",
    "yunet_eyes",
]
