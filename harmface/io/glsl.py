"""GLSL: the nine coefficients of [RH01]_ eq. 13 and the matrices of eq. 12, to write only.

References
----------
.. [RH01] Ramamoorthi and Hanrahan, An Efficient Representation for Irradiance Environment
   Maps, SIGGRAPH 2001.
"""

import numpy as np
from jaxtyping import Float

from harmface.errors import ArgumentError
from harmface.rendering import irradiance_matrix

_NAMES = ("L00", "L1m1", "L10", "L11", "L2m2", "L2m1", "L20", "L21", "L22")


def glsl_uniforms(light: Float[np.ndarray, "channels K"]) -> str:
    """Return GLSL with the coefficients, a matrix a channel, and the function that uses them.

    Parameters
    ----------
    light
        Coefficients of one channel or three, of degree 2 or more, in the frame of the normals.

    Raises
    ------
    ArgumentError
        If there are fewer than nine, or two channels.
    """
    light = np.atleast_2d(light)
    if light.shape[-1] < 9 or len(light) not in (1, 3):
        raise ArgumentError(
            f"light must have one channel or three of nine coefficients, got shape {light.shape}"
        )
    light = np.broadcast_to(light[:, :9], (3, 9))
    lines = ["// Lighting coefficients of radiance, RH01 eq. 3 and 10."]
    lines += [
        f"const vec3 {name} = vec3({', '.join(f'{value:.9g}' for value in column)});"
        for name, column in zip(_NAMES, light.T, strict=True)
    ]
    lines.append("// E(n) = dot(n4, M * n4) with n4 = vec4(n, 1), RH01 eq. 11-12; M is symmetric.")
    for name, own in zip(("Mr", "Mg", "Mb"), light, strict=True):
        numbers = ", ".join(f"{value:.9g}" for value in irradiance_matrix(own).ravel())
        lines.append(f"const mat4 {name} = mat4({numbers});")
    lines += [
        "vec3 irradiance(vec3 n) {",
        "    vec4 n4 = vec4(n, 1.0);",
        "    return vec3(dot(n4, Mr * n4), dot(n4, Mg * n4), dot(n4, Mb * n4));",
        "}",
    ]
    return "\n".join(lines) + "\n"
