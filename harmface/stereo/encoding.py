"""Whether photographs are linear."""

import numpy as np
from jaxtyping import Float

from harmface.conventions import srgb_to_linear
from harmface.stereo.factorization import factorize

GAIN = 1.1
"""Energy outside rank 4, decoded over as given, below which images count as gamma-encoded. Of
rendered linear stacks, with noise, cast shadows and highlights, it was 1.4 to 25."""

NOTICEABLE = 1e-4
"""Share of energy outside rank 4 from which encoding can be told from noise."""


def looks_gamma_encoded(values: Float[np.ndarray, "F p"]) -> bool:
    """Return whether the images come nearer to rank 4 when the sRGB curve is undone.

    Linear images of a diffuse object under point sources have rank 3 but for attached shadows;
    the curve bends them out. Under soft light of little contrast the curve is nearly a power,
    which changes the albedo and keeps the rank, and highlights leave more outside rank 4 than the
    curve does: then this says nothing. So images are never refused for it.

    Parameters
    ----------
    values
        Images as rows of pixels.
    """
    if min(values.shape) <= 4:
        return False
    some = values[:, :: max(1, values.shape[1] // 4096)].astype(np.float64)
    some = some / some.max()
    outside = [1 - factorize(each, 4).energy[3] for each in (some, srgb_to_linear(some))]
    return bool(outside[0] > NOTICEABLE and outside[1] < GAIN * outside[0])
