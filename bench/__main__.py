"""``python -m bench [NAME ...] [--json]``: runs benchmarks and prints one table (or a line of JSON each)."""

import argparse
import json
import sys
from collections.abc import Callable
from typing import Any

from bench import accuracy, clients, recovery

BENCHMARKS: dict[str, Callable[[], list[dict[str, Any]]]] = {
    "accuracy": accuracy.run,
    "clients": clients.run,
    "recovery": recovery.run,
}


def main() -> int:
    """Run the named benchmarks, all without a name."""
    parser = argparse.ArgumentParser(prog="python -m bench", description=__doc__)
    parser.add_argument("names", nargs="*", metavar="NAME", help=", ".join(BENCHMARKS))
    parser.add_argument("--json", action="store_true", help="one line of JSON per benchmark")
    arguments = parser.parse_args()
    if unknown := [name for name in arguments.names if name not in BENCHMARKS]:
        parser.error(f"no benchmark {unknown[0]!r}; there are {', '.join(BENCHMARKS)}")
    for name in arguments.names or BENCHMARKS:
        results = BENCHMARKS[name]()
        if arguments.json:
            print(json.dumps({"bench": name, "results": results}))
            continue
        print(f"\n{name}")
        for row in results:
            print(f"  {row['name']:<44} {row['value']!s:>12} {row['unit']}")
    return 0


if __name__ == "__main__":
    sys.exit(main())
