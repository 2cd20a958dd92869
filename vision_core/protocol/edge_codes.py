"""Edge types on the wire: the letter of every code, in the paper's three representations (section 3.2)."""

from collections.abc import Mapping
from types import MappingProxyType

import numpy as np

from vision_core.errors import SettingsError
from vision_core.geometry import Bytes, frozen
from vision_core.types.edges import EDGE_TYPES, UNDEFINED, Letter, letter_faults

TYPES = ("same", "team", "number")
"""The representations that a client may ask for with ``(types ...)``."""

EdgeCodes = Mapping[str, Bytes]
"""By representation: the ASCII letter of each code, shape (256,), read-only."""


def edge_codes(chosen: Mapping[str, str] | None = None) -> EdgeCodes:
    """The letters of ``types.edges.EDGE_TYPES``, of which `chosen` replaces some.

    chosen: letters by key, as in the settings' protocol.letters. Raises SettingsError unless every key is known and
    every letter is a printable character of one meaning only.
    """
    chosen = chosen or {}
    for key, found, accepted in letter_faults(chosen):
        raise SettingsError(f"protocol.letters.{key}", found=found, accepted=accepted)

    def ascii_of(letter: Letter) -> int:
        return ord(chosen.get(letter.key, letter.default))

    codes = {}
    for types in TYPES:
        letters = np.full(256, ord(UNDEFINED), dtype=np.uint8)
        for edge in EDGE_TYPES:
            letters[edge.codes] = ascii_of(getattr(edge, types))
            if types == "number" and edge.numbered:
                letters[edge.codes[1:]] = ascii_of(edge.numbered) + np.arange(edge.numbered.count)
        codes[types] = frozen(letters)
    return MappingProxyType(codes)
