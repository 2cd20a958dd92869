"""Process that runs for a moment before the service: can the source be opened? Settings on standard input."""

import sys

import msgspec

from vision_core.capture.source import open_source
from vision_core.clock import MonotonicClock
from vision_core.errors import PslvError
from vision_core.settings import Settings


def main() -> int:
    """Open the source and close it; exit status 2 and one line on standard error when that fails."""
    settings = msgspec.json.decode(sys.stdin.buffer.read(), type=Settings)
    try:
        open_source(settings, MonotonicClock()).close()
    except PslvError as error:
        print(error, file=sys.stderr)
        return 2
    return 0


if __name__ == "__main__":
    sys.exit(main())
