"""``python -m bench [NAME ...] [--json]``: runs benchmarks, see ``bench.runner``."""

import argparse

from bench.runner import BENCHMARKS, run_all


def main() -> None:
    """Run the named benchmarks, all without a name."""
    parser = argparse.ArgumentParser(prog="python -m bench", description=__doc__)
    parser.add_argument("names", nargs="*", metavar="NAME", help=", ".join(BENCHMARKS))
    parser.add_argument("--json", action="store_true", help="one line of JSON per benchmark")
    arguments = parser.parse_args()
    if unknown := [name for name in arguments.names if name not in BENCHMARKS]:
        parser.error(f"no benchmark {unknown[0]!r}; there are {', '.join(BENCHMARKS)}")
    run_all(tuple(arguments.names), as_json=arguments.json)


if __name__ == "__main__":
    main()
