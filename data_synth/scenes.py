"""Lamps around an object, as a text that programs read."""

THREE_LAMPS = """\
# Lamps near an object. Lengths are heights of the object's bounding box, and the origin is its
# middle: x right, y up, z towards the viewer. With frame = "world" they are the mesh's own.
# Radiance is red, green, blue; flat lamps shine to the side from which their vertices run
# counter-clockwise, or to that of their normal.
frame = "object"

# A large red window to the left, in front of the object.
[[polygon]]
vertices = [[-0.9, -0.5, 0.5], [-0.9, 0.6, 0.5], [-0.3, 0.6, 1.2], [-0.3, -0.5, 1.2]]
radiance = [6.0, 1.2, 0.6]

# A blue lamp before a part of it: what it hides differs from place to place.
[[disc]]
center = [-0.4, 0.3, 0.75]
normal = [0.45, -0.3, -0.84]
radius = 0.12
radiance = [2.0, 6.0, 30.0]

# A small warm globe to the upper right.
[[sphere]]
center = [0.75, 0.5, 0.35]
radius = 0.12
radiance = [20.0, 14.0, 6.0]
"""
"""Three coloured lamps of which one hides a part of another, less than a head's height away."""
