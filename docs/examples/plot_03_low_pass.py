"""
A diffuse surface is a low-pass filter
======================================

Irradiance is the convolution of the radiance with the clamped cosine. Its harmonic coefficients
:math:`A_l` fall off so fast that degree 2 keeps 99.2 % of the energy (BJ03), and that the largest
error at any angle is bounded.
"""

import numpy as np
from matplotlib.figure import Figure

from harmface.reflectance import energy_by_degree, lambert_coefficients, truncation_error

degrees = np.arange(9)
figure = Figure(figsize=(9, 3), layout="constrained")
transfer, energy = figure.subplots(1, 2)
transfer.stem(degrees, lambert_coefficients(8), basefmt="k-")
transfer.set(xlabel="degree $l$", ylabel="$A_l$", title="what irradiance keeps of the radiance")
energy.semilogy(degrees, 1 - np.cumsum(energy_by_degree(8)), "o-", label="energy left out")
energy.semilogy(degrees, [truncation_error(d) for d in range(9)], "s-", label="largest error")
energy.set(xlabel="highest degree", title="what a truncation leaves out")
energy.legend(frameon=False)
