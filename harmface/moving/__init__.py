"""Shape, albedo and light from a film of a moving object under light that stands still."""

from harmface.moving.film import FilmSurface, surface_from_film
from harmface.moving.shading import TrackedShading, fit_tracks
from harmface.moving.silhouettes import silhouettes
from harmface.moving.views import Views, views_from_cameras, views_from_poses

__all__ = [
    "FilmSurface",
    "TrackedShading",
    "Views",
    "fit_tracks",
    "silhouettes",
    "surface_from_film",
    "views_from_cameras",
    "views_from_poses",
]
