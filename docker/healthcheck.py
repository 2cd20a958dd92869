"""Is the service of this container ready? Exit status 0 or 1, with the reasons. Standard library only."""

import json
import os
import sys
import urllib.error
import urllib.request

ANYWHERE = ("", "0.0.0.0", "::")  # noqa: S104 (an address to compare with)


def main() -> int:
    """Ask the service at the address that it was told to listen on."""
    host, port = os.environ.get("PSLV_HOST", ""), os.environ.get("PSLV_PORT") or "8000"
    try:
        with urllib.request.urlopen(f"http://{'127.0.0.1' if host in ANYWHERE else host}:{port}/readyz", timeout=2.0):
            return 0
    except urllib.error.HTTPError as error:
        print("; ".join(json.load(error)["reasons"]))
    except OSError as error:
        print(error)
    return 1


if __name__ == "__main__":
    sys.exit(main())
