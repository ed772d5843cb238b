"""
The same light in four layouts
==============================

Lat-long, cube, angular map and mirror ball show the same directions at other places; the nine numbers
do not change.
"""

import numpy as np
from matplotlib.figure import Figure

from data_synth.environments import ENVIRONMENTS, rasterise
from harmface.light import EnvironmentMap, image_from_faces, project, resample
from harmface.viz import show_linear

room = EnvironmentMap.from_image(rasterise(ENVIRONMENTS["room"](), 256))
figure = Figure(figsize=(11, 2.8), layout="constrained")
for axes, layout in zip(
    figure.subplots(1, 4, width_ratios=(2, 4 / 3, 1, 1)),
    ("latlong", "cube", "angular", "mirror-ball"),
    strict=True,
):
    drawn = resample(room, layout, 96)
    image = drawn.as_image()
    image = image_from_faces(image, "horizontal-cross") if layout == "cube" else image
    toned = image / (image + np.median(image[image > 0]))
    show_linear(axes, np.moveaxis(toned, -1, 0), layout)
    print(layout, project(drawn, 2)[1, :4].round(4))
