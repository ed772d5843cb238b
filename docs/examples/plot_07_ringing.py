"""
Ringing, and windows against it
===============================

Nine coefficients of a small bright sun give a slightly negative irradiance behind the surface. A window
lowers the higher degrees; the non-negative one is the mildest under which no light goes below zero.
"""

import numpy as np
from matplotlib.figure import Figure

from harmface.conventions import light_direction
from harmface.light import disc, hann_window, non_negative_window, windowed
from harmface.reflectance import lambert_coefficients
from harmface.rendering import harmonic_irradiance

sun = disc(np.array([0.0, 0.0, 1.0]), np.radians(0.27), 1.0, 2)
angles = np.linspace(0, 180, 181)
normals = np.stack([light_direction(angle, 0) for angle in angles])
windows = {
    "none": np.ones(3),
    "Hann, width 5": hann_window(2, 5.0),
    "non-negative": non_negative_window(lambert_coefficients(2)),
}
axes = (figure := Figure(figsize=(7, 3.4), layout="constrained")).add_subplot()
axes.plot(angles, np.maximum(np.cos(np.radians(angles)), 0), "k", lw=1, label="exact")
for name, window in windows.items():
    axes.plot(angles, harmonic_irradiance(windowed(sun, window), normals), label=name)
axes.axhline(0, color="0.7", lw=0.8)
axes.set(xlabel="angle between normal and sun / degrees", ylabel="irradiance / that at normal")
axes.legend(frameon=False)
