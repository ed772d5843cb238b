"""Subjects from photographs: their surfaces, and what they look like in light not photographed."""

from harmface.enrollment.photographs import from_known_lights, from_stereo, with_relit
from harmface.enrollment.subject import RelitSubject

__all__ = ["RelitSubject", "from_known_lights", "from_stereo", "with_relit"]
