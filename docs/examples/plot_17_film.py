"""
A surface from a film
=====================

A bumpy sphere turns to and fro while lamps and camera stand still. How it moves is known; light, surface
and albedo are found.
"""

import numpy as np

from data_synth.shapes import bumpy_sphere
from harmface.light import DistantLight
from harmface.moving import surface_from_film
from harmface.reproduce.films import rendered_film, turns
from harmface.reproduce.moving import head_errors
from harmface.reproduce.synthetic import mesh_of
from harmface.sphere import fibonacci_directions
from harmface.viz import film_figure

directions = fibonacci_directions(60)
light = DistantLight(directions, np.maximum(0.3 + directions[:, 1] + directions[:, 0] / 2, 0))
rotations = turns("yaw:-30:30,pitch:-15:15", 24)
film = rendered_film(mesh_of(bumpy_sphere()), rotations, light, 64, noise=0.01, rng=0)

found = surface_from_film(film.frames, film.masks, film.views)
figure = film_figure(film.frames, film.views, found)
angles, depth = head_errors(film, found)
print(f"normals {angles.mean():.1f} degrees off, depth {depth.mean():.1%} of the object's")
