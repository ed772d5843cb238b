"""The pixels of a Radiance picture, four bytes each: flat, or in run lengths old or new."""

import numpy as np
from jaxtyping import UInt8

_SHORTEST, _LONGEST = 8, 32767
"""Lengths of scanlines that new run lengths are for."""


def decode_scanlines(
    data: bytes, start: int, scanlines: int, length: int
) -> UInt8[np.ndarray, "n m 4"]:
    """Return the four bytes of every pixel.

    New run lengths code each of the four bytes by itself, and announce every scanline by 2, 2 and
    its length. Old ones are pixels of (1, 1, 1, n), which repeat the one before n times; several
    in a row have n from its lowest byte on.

    Parameters
    ----------
    data
        The file.
    start
        Where the pixels start.
    scanlines, length
        How many there are, and pixels in each.

    Raises
    ------
    EOFError
        If pixels are missing.
    ValueError
        If they make no sense.
    """
    size = scanlines * length
    stored = len(data) - start
    announced = bytes([2, 2, length >> 8 & 0xFF, length & 0xFF])
    if _SHORTEST <= length <= _LONGEST and data.startswith(announced, start):
        try:
            return _new(data, start, scanlines, length, announced)
        except ValueError:
            # So may the first pixel of a picture without run lengths look.
            if stored != 4 * size:
                raise
    codes = np.frombuffer(data, np.uint8, 4 * (stored // 4), start).reshape(-1, 4)
    runs = (codes[:, :3] == 1).all(axis=1)
    if stored == 4 * size or (stored > 4 * size and not runs.any()):
        return codes[:size].reshape(scanlines, length, 4)
    return _old(codes, runs, size).reshape(scanlines, length, 4)


def _new(
    data: bytes, start: int, scanlines: int, length: int, announced: bytes
) -> UInt8[np.ndarray, "n m 4"]:
    found = np.empty((scanlines, length, 4), np.uint8)
    place = start
    for row in found:
        if place + 4 > len(data):
            raise EOFError("it is cut off")
        if not data.startswith(announced, place):
            raise ValueError("a scanline has another length")
        place += 4
        values = bytearray()
        for end in range(length, 4 * length + 1, length):
            while len(values) < end:
                if place + 1 >= len(data):
                    raise EOFError("it is cut off")
                count = data[place]
                if count > 128:
                    values += data[place + 1 : place + 2] * (count - 128)
                    place += 2
                elif count:
                    values += data[place + 1 : place + 1 + count]
                    place += 1 + count
                else:
                    raise ValueError("a run has no length")
            if len(values) > end:
                raise ValueError("a run is longer than its scanline")
        row[:] = np.frombuffer(values, np.uint8).reshape(4, length).T
    if place > len(data):
        raise EOFError("it is cut off")
    return found


def _old(
    codes: UInt8[np.ndarray, "n 4"], runs: np.ndarray, size: int
) -> UInt8[np.ndarray, "size 4"]:
    if not len(codes) or runs[0]:
        raise ValueError("it starts with a run")
    index = np.arange(len(codes))
    last = np.maximum.accumulate(np.where(runs, 0, index))
    follows = index - last - 1
    if follows.max() > 3:
        raise ValueError("a run has more than four bytes")
    lengths = np.ones(len(codes), np.int64)
    lengths[runs] = codes[runs, 3].astype(np.int64) << 8 * follows[runs]
    # Of many runs the sum could leave 64 bits, if it went on.
    ends = np.cumsum(np.minimum(lengths, size + 1)[: size + 1])
    if ends[-1] != size or len(ends) != len(codes):
        raise ValueError(f"it has {min(ends[-1], size + 1)} pixels or more, {size} are promised")
    return np.repeat(codes[last].view("<u4")[:, 0], lengths).view(np.uint8).reshape(-1, 4)
