"""Entry point of ``pslv``: standard library only, so that it can say what is missing."""

import signal
import sys
from importlib.util import find_spec
from types import FrameType

NEEDED = ("msgspec", "numba", "cv2", "fastapi", "uvicorn", "typer", "rich", "platformdirs", "prometheus_client")

EXAMINATIONS = ("check", "conformance", "check-client")
"""Commands that need NumPy only, as ``client``."""


def main() -> None:
    """Run the command line, or name the extra that it needs."""
    if sys.argv[1:2] == ["serve"]:
        for number in (signal.SIGINT, signal.SIGTERM):
            signal.signal(number, _leave)
    missing = [name for name in NEEDED if find_spec(name) is None]
    if missing and sys.argv[1:2] == ["client"]:
        from vision_core.client.__main__ import main as client

        sys.exit(client(sys.argv[2:]))
    if missing and sys.argv[1:2] and sys.argv[1] in EXAMINATIONS:
        from vision_core.examination.__main__ import main as examine

        sys.exit(examine(sys.argv[1:]))
    if missing:
        print(
            f"pslv: this command needs the server extra ({', '.join(missing)} not found): "
            "pip install 'pslv[server]'; without it work: pslv client, check, check-client, conformance",
            file=sys.stderr,
        )
        sys.exit(2)
    from app.cli import run

    run()


def _leave(_number: int, _frame: FrameType | None) -> None:
    """A stop while the service is still starting is a stop like any other; the supervisor has its own handler."""
    sys.exit(0)


if __name__ == "__main__":
    main()
