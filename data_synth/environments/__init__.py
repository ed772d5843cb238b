"""Environments: radiance as a function of direction, rasterised or integrated as asked."""

from collections.abc import Callable
from functools import partial

from data_synth.environments.environment import (
    Environment,
    latlong_directions,
    quadrature,
    rasterise,
)
from data_synth.environments.interiors import nave, room, studio
from data_synth.environments.random_field import random_field
from data_synth.environments.sky import clear_sky, overcast_sky
from data_synth.environments.street import street

__all__ = [
    "ENVIRONMENTS",
    "Environment",
    "clear_sky",
    "latlong_directions",
    "nave",
    "overcast_sky",
    "quadrature",
    "random_field",
    "rasterise",
    "room",
    "street",
    "studio",
]

ENVIRONMENTS: dict[str, Callable[[], Environment]] = {
    "overcast_sky": overcast_sky,
    "clear_sky": partial(clear_sky, disc=False),
    "clear_sky_sun": clear_sky,
    "room": room,
    "studio": studio,
    "street": street,
    "nave": nave,
    "random_field": random_field,
}
"""Every environment at its defaults."""
