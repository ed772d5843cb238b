"""
Turning the light
=================

A rotation mixes the harmonics of one degree among themselves, and leaves the energy of each degree as
it is (R05 eq. 16). Here a street turns about the vertical.
"""

from matplotlib.figure import Figure
from scipy.spatial.transform import Rotation

from data_synth.environments import ENVIRONMENTS, rasterise
from harmface.light import EnvironmentMap, project
from harmface.rendering import irradiance_map
from harmface.sphere import energy_per_degree, rotate
from harmface.viz import show_linear

street = project(EnvironmentMap.from_image(rasterise(ENVIRONMENTS["street"](), 256)), 2)
figure = Figure(figsize=(11, 2.0), layout="constrained")
for axes, angle in zip(figure.subplots(1, 4), (0, 60, 120, 180), strict=True):
    turned = rotate(street, Rotation.from_euler("y", angle, degrees=True).as_matrix())
    received = irradiance_map(turned, "latlong", 64)
    show_linear(axes, received / received.max(), f"turned by {angle}°")
    print(angle, energy_per_degree(turned)[1].round(4))
