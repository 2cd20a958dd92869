"""Where every record lies in the block. Writers and readers compute it alike from the list of records."""

from collections.abc import Iterable
from dataclasses import dataclass

CACHE_LINE = 64
"""Head and slots start on a cache line, so that 8-byte fields are written at once [bytes]."""
SLOT_HEADER = CACHE_LINE
PAGE = 4096


@dataclass(frozen=True, slots=True)
class RecordSpec:
    """One record of the database."""

    name: str
    capacity: int
    """Largest payload [bytes]."""
    validity_s: float
    """Age up to which a value is valid [s]; 0: for ever."""
    slots: int = 4
    checksum: bool = True
    """CRC over the payload. Off for images, where reading every byte would cost too much."""

    @property
    def slot_bytes(self) -> int:
        return SLOT_HEADER + _aligned(self.capacity, CACHE_LINE)

    @property
    def total_bytes(self) -> int:
        return _aligned(CACHE_LINE + self.slots * self.slot_bytes, PAGE)


def offsets(specs: Iterable[RecordSpec]) -> tuple[dict[str, int], int]:
    """First byte of each record by name, and the size of the block. Raises ValueError for a repeated name."""
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
