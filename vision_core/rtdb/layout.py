"""Where everything lies in the block: computed the same way on both sides from the list of records."""

from collections.abc import Iterable
from dataclasses import dataclass

LINE = 64
"""A cache line; head and slots start on one, so that 8-byte fields are written at once."""
SLOT_HEADER = LINE
PAGE = 4096


@dataclass(frozen=True, slots=True)
class RecordSpec:
    """One record of the database."""

    name: str
    capacity: int
    """Largest payload [bytes]."""
    validity_s: float
    """Older than this since it was measured it is not valid any more; 0: valid for ever."""
    slots: int = 4
    checksum: bool = True
    """CRC over the payload; off for images, where looking at every byte costs more than it tells."""

    @property
    def slot_bytes(self) -> int:
        return SLOT_HEADER + _aligned(self.capacity, LINE)

    @property
    def total_bytes(self) -> int:
        return _aligned(LINE + self.slots * self.slot_bytes, PAGE)


def offsets(specs: Iterable[RecordSpec]) -> tuple[dict[str, int], int]:
    """First byte of each record by name, and the size of the whole block."""
    places: dict[str, int] = {}
    end = 0
    for spec in specs:
        if spec.name in places:
            raise ValueError(f"record {spec.name!r} is declared twice")
        places[spec.name] = end
        end += spec.total_bytes
    return places, end


def _aligned(size: int, step: int) -> int:
    return -(-size // step) * step
