"""
An environment, nine numbers, and the irradiance they give
==========================================================

A map of radiance is projected to nine coefficients a channel; irradiance follows from them without
looking at the map again (RH01 eq. 7 and 10).
"""

from data_synth.environments import ENVIRONMENTS, rasterise
from harmface.light import EnvironmentMap, project
from harmface.viz import environment_figure

environment = EnvironmentMap.from_image(rasterise(ENVIRONMENTS["street"](), 256))
coefficients = project(environment, 2)
figure = environment_figure(environment, coefficients)

# %%
# The nine numbers of the green channel, in the order of `k = l (l + 1) + m`:
print(coefficients[1].round(3))
