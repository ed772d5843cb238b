"""What a tool's lighting coefficients mean: order, signs, factors, frame, shape of the array."""

from dataclasses import dataclass, field

import numpy as np
from jaxtyping import Float

from harmface import checks
from harmface.conventions import max_degree_of
from harmface.errors import ArgumentError
from harmface.light.frames import transformed


@dataclass(frozen=True, eq=False)
class Convention:
    """How a tool stores nine coefficients of light, or as many as it has.

    A value of the tool is `c_i = factors_i L_k + offsets_i` with `k = order_i`, where `L` are the
    lighting coefficients in the tool's own frame.

    Parameters
    ----------
    name
        On the command line.
    order
        Flat index `k = l (l + 1) + m` of each value, the axes being the tool's own.
    factors
        By which the coefficient of radiance is multiplied to give the value.
    stored
        What the values are, in words.
    source
        Where this is read from.
    frame
        Orthogonal matrix that carries the tool's directions into ours.
    channels_first
        Whether an array is (channels, values), and not (values, channels).
    offsets
        Added to the values.
    grey
        Whether there is one channel only.
    """

    name: str
    order: tuple[int, ...]
    factors: tuple[float, ...]
    stored: str
    source: str
    frame: Float[np.ndarray, "3 3"] = field(default_factory=lambda: np.eye(3))
    channels_first: bool = False
    offsets: tuple[float, ...] | None = None
    grey: bool = False

    @property
    def shape(self) -> tuple[int, ...]:
        """Shape of the tool's array."""
        count = len(self.order)
        if self.grey:
            return (count,)
        return (3, count) if self.channels_first else (count, 3)

    def decode(self, values: Float[np.ndarray, "..."]) -> Float[np.ndarray, "channels K"]:
        """Return lighting coefficients from a tool's array.

        Parameters
        ----------
        values
            The array, of the tool's shape or flat; axes of length 1 in front are left out.

        Returns
        -------
        numpy.ndarray
            Coefficients of radiance in our frame, shape (channels, K), float64.

        Raises
        ------
        ArgumentError
            If the shape is another, a value is not finite, or the light is dark on average, which
            none is.
        """
        values = np.asarray(checks.finite("values", values), np.float64)
        while values.ndim > 1 and values.shape[0] == 1:
            values = values[0]
        if values.size != np.prod(self.shape) or values.shape not in (self.shape, (values.size,)):
            expected = " x ".join(map(str, self.shape))
            raise ArgumentError(
                f"coefficients of {self.name} must be {np.prod(self.shape)} numbers, {expected}, "
                f"got shape {values.shape}"
            )
        table = values.reshape(self.shape)
        own = table[None] if self.grey else table if self.channels_first else table.T
        if self.offsets is not None:
            own = own - np.array(self.offsets)
        light = np.empty_like(own)
        light[:, list(self.order)] = own / np.array(self.factors)
        if not (light[:, 0] > 0).all():
            raise ArgumentError(
                f"coefficients cannot be those of {self.name}: light cannot be dark on average, "
                f"got L_00 = {light[:, 0].min():.4g}"
            )
        return transformed(light, self.frame)

    def encode(self, light: Float[np.ndarray, "channels K"]) -> Float[np.ndarray, "..."]:
        """Return a tool's array from lighting coefficients, the inverse of `decode`.

        Parameters
        ----------
        light
            Coefficients, of one channel or three; degrees that the tool has not are left out.

        Returns
        -------
        numpy.ndarray
            Of the tool's shape, float64.

        Raises
        ------
        ArgumentError
            If there are fewer degrees than the tool has, or a colour for a tool without.
        """
        light = np.atleast_2d(np.asarray(checks.finite("light", light), np.float64))
        count = len(self.order)
        max_degree_of(light.shape[-1])
        if light.shape[-1] < count or len(light) not in (1, 3):
            raise ArgumentError(
                f"light must have one channel or three of {count} coefficients for {self.name}, "
                f"got shape {light.shape}"
            )
        if self.grey and len(light) != 1:
            raise ArgumentError(
                f"{self.name} has one channel, got {len(light)}; give it the luminance"
            )
        if not self.grey and len(light) == 1:
            light = np.repeat(light, 3, axis=0)
        turned = transformed(light[:, :count], self.frame.T)
        own = turned[:, list(self.order)] * np.array(self.factors)
        if self.offsets is not None:
            own = own + np.array(self.offsets)
        if self.grey:
            return own[0]
        return own if self.channels_first else own.T
