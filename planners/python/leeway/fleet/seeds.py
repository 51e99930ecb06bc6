# SPDX-License-Identifier: BSD-3-Clause
"""Random numbers by address: those of a row are a function of the campaign's seed, the names of its part, and the row's number.

Philox (Salmon et al. 2011, "Parallel random numbers: as easy as 1, 2, 3") counts: any row's numbers are made without those before it. Raw
words are used, which NumPy keeps for good, and made numbers in [0, 1) here.
"""
from __future__ import annotations

import hashlib

import numpy

__all__ = ["key_of", "rows_of", "stream_of"]


def key_of(*names: object) -> int:
    """128 bits of some names and numbers."""
    text = "\x1f".join(str(name) for name in names)
    return int.from_bytes(hashlib.sha256(text.encode()).digest()[:16], "little")


def _uniform(words: numpy.ndarray) -> numpy.ndarray:
    return (words >> numpy.uint64(11)) * 2.0**-53


def rows_of(key: int, begin: int, end: int, width: int) -> numpy.ndarray:
    """float64 [end - begin, width] in [0, 1): the numbers of rows begin to end."""
    stride = -(-width // 4)  # Philox makes four words at once
    bits = numpy.random.Philox(key=key)
    bits.advance(begin * stride)
    return _uniform(bits.random_raw((end - begin) * stride * 4)).reshape(end - begin, stride * 4)[:, :width]


class stream_of:
    """Random numbers one after the other, for one row or one scene."""

    def __init__(self, *names: object):
        self._bits = numpy.random.Philox(key=key_of(*names))

    def uniform(self, low=0.0, high=1.0, size=None):
        """As numpy.random.Generator.uniform()."""
        shape = size if size is not None else numpy.broadcast(low, high).shape
        count = int(numpy.prod(shape))
        numbers = _uniform(self._bits.random_raw(max(count, 1)))[:count].reshape(shape)
        found = low + numbers * (numpy.asarray(high) - low)
        return float(found) if found.shape == () else found

    def integer(self, low: int, high: int) -> int:
        """One of low, ..., high."""
        return low + min(int(self.uniform() * (high - low + 1)), high - low)

    def choice_sign(self) -> int:
        """-1 or 1."""
        return 2 * self.integer(0, 1) - 1
