"""Damage to bytes: what accidents, other programs and malice do to files."""

import json
from collections.abc import Callable, Sequence
from typing import Any

import numpy as np

INTEGERS = (0, 1, 2, 127, 128, 255, 256, 32767, 32768, 65535, 65536, 10**6)
INTEGERS += (2**24, 2**31 - 1, 2**31, 2**32 - 1, 2**62, 2**63 - 1, 2**64 - 1)
NUMBERS = (b"0", b"-1", b"2", b"1e999", b"-1e999", b"nan", b"Infinity", b"1e-999", b"1e200")
NUMBERS += (b"4294967295", b"99999999999", b"-2147483649", b"0x10", b"1_0", b"1,5", b"65536")
NUMBERS += (b"9" * 5000, b"", b"\x00", b"\xff", "٣".encode(), b"1e5")
VALUES: tuple[Any, ...] = (None, True, -1, 0, 0.5, 1e3, 2**31, 2**63, 10**400, 1e308 * 10)
VALUES += (float("nan"), "", "x", "../x", "/dev/zero", "\0", "\ud800", "é" * 300, [], {})
VALUES += ([["a"]], {"a": 1}, [1], [[]], [None], list(range(1000)))
DEEP = (b"[" * 100_000, b'{"a":' * 50_000, b"(" * 3000)

Damage = Callable[[bytearray, np.random.Generator], None]


def mutated(data: bytes, rng: np.random.Generator, tokens: Sequence[bytes]) -> bytes:
    """Return data with one to four kinds of damage done to it."""
    if rng.random() < 0.4 and (changed := with_odd_value(data, rng)) is not None:
        return changed
    found = bytearray(data)
    for _ in range(int(rng.integers(1, 5))):
        if len(tokens) and rng.random() < 0.25:
            _put(found, tokens[rng.integers(len(tokens))], rng)
        else:
            DAMAGES[rng.integers(len(DAMAGES))](found, rng)
    return bytes(found)


def with_odd_value(data: bytes, rng: np.random.Generator) -> bytes | None:
    """Return a JSON text with one value replaced by an odd one; None if it is no such text."""
    try:
        tree = json.loads(data)
    except (ValueError, RecursionError):
        return None
    places: list[tuple[Any, Any]] = []

    def visit(node: Any) -> None:
        for key in node if isinstance(node, dict) else range(len(node)):
            places.append((node, key))
            if isinstance(node[key], dict | list):
                visit(node[key])

    if not isinstance(tree, dict | list):
        return None
    visit(tree)
    if not places:
        return None
    node, key = places[rng.integers(len(places))]
    choice = rng.integers(len(VALUES) + 2)
    if choice == len(VALUES):
        del node[key]
    elif choice == len(VALUES) + 1:
        node[key] = "DEEP"
    else:
        node[key] = VALUES[choice]
    return json.dumps(tree).encode().replace(b'"DEEP"', DEEP[rng.integers(len(DEEP))])


def _flip(data: bytearray, rng: np.random.Generator) -> None:
    for _ in range(int(rng.integers(1, 9))):
        if data:
            data[rng.integers(len(data))] ^= 1 << int(rng.integers(8))


def _byte(data: bytearray, rng: np.random.Generator) -> None:
    if data:
        data[rng.integers(len(data))] = int(rng.integers(256))


def _number(data: bytearray, rng: np.random.Generator) -> None:
    """Overwrite a binary number, mostly near the front, where headers are."""
    size = int(rng.choice([1, 2, 4, 8]))
    value = INTEGERS[rng.integers(len(INTEGERS))] % 256**size
    reach = len(data) if rng.random() < 0.5 else min(len(data), 128)
    place = int(rng.integers(max(1, reach)))
    data[place : place + size] = value.to_bytes(size, rng.choice(["little", "big"]))


def _text_number(data: bytearray, rng: np.random.Generator) -> None:
    """Replace a run of digits by another number."""
    if not data:
        return
    start = int(rng.integers(len(data)))
    while start < len(data) and not 48 <= data[start] <= 57:
        start += 1
    while start > 0 and 48 <= data[start - 1] <= 57:
        start -= 1
    end = start
    while end < len(data) and (48 <= data[end] <= 57 or data[end] == 46):
        end += 1
    if end > start:
        data[start:end] = NUMBERS[rng.integers(len(NUMBERS))]


def _span(data: bytearray, rng: np.random.Generator) -> slice:
    start = int(rng.integers(len(data) + 1))
    return slice(start, start + int(rng.geometric(1 / (1 + rng.integers(64)))))


def _delete(data: bytearray, rng: np.random.Generator) -> None:
    del data[_span(data, rng)]


def _repeat(data: bytearray, rng: np.random.Generator) -> None:
    span = _span(data, rng)
    data[span] = data[span] * int(rng.choice([2, 3, 100]))


def _move(data: bytearray, rng: np.random.Generator) -> None:
    span = _span(data, rng)
    piece = bytes(data[span])
    del data[span]
    _put(data, piece, rng)


def _noise(data: bytearray, rng: np.random.Generator) -> None:
    data[_span(data, rng)] = rng.bytes(int(rng.integers(1, 32)))


def _cut(data: bytearray, rng: np.random.Generator) -> None:
    del data[int(rng.integers(len(data) + 1)) :]


def _extend(data: bytearray, rng: np.random.Generator) -> None:
    data += rng.bytes(int(rng.integers(1, 200)))


def _deep(data: bytearray, rng: np.random.Generator) -> None:
    # Rare: the other damages then matter little.
    if rng.random() < 0.1:
        _put(data, DEEP[rng.integers(len(DEEP))], rng)


def _put(data: bytearray, piece: bytes, rng: np.random.Generator) -> None:
    place = int(rng.integers(len(data) + 1))
    end = place + (len(piece) if rng.random() < 0.5 else 0)
    data[place:end] = piece


DAMAGES: tuple[Damage, ...] = (
    *(_flip, _byte, _number, _number, _text_number, _text_number),
    *(_delete, _repeat, _move, _noise, _cut, _extend, _deep),
)
