# SPDX-License-Identifier: BSD-3-Clause
# Copyright (c) 2026 The e2e_cdiff authors
"""Random draws of a sealed suite: SHA-256 of a name and a counter, so that they are the same on every machine and with
every version of Python."""
import hashlib


class Draws:
    """A stream of draws named after what it decides, e.g. "71401/sealed_a_random_1/0"."""

    def __init__(self, name):
        self.name = name
        self.count = 0

    def unit(self):
        """Uniform in [0, 1): the first 52 bits of SHA-256("NAME/COUNT"), COUNT = 1, 2, ..."""
        self.count += 1
        digest = hashlib.sha256(f"{self.name}/{self.count}".encode()).hexdigest()
        return int(digest[:13], 16) / 2.0**52

    def uniform(self, low, high):
        """Uniform between the bounds, rounded to 0.1 so that files hold short numbers."""
        return round(low + (high - low) * self.unit(), 1)

    def whole(self, low, high):
        """A whole number from low to high, both possible."""
        return low + int(self.unit() * (high - low + 1))

    def pick(self, values):
        return values[self.whole(0, len(values) - 1)]
