"""``python -m bench [NAME ...] [--json]`` runs the named benchmarks, or all without a name."""

import argparse

from bench.runner import BENCHMARKS, run_all, summary_of


def main() -> None:
    """Parse the command line and run the benchmarks."""
    width = max(map(len, BENCHMARKS))
    listing = "\n".join(f"  {name:<{width}}  {summary_of(name)}" for name in BENCHMARKS)
    parser = argparse.ArgumentParser(
        prog="python -m bench",
        description=__doc__,
        epilog=f"benchmarks:\n{listing}",
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    parser.add_argument("names", nargs="*", metavar="NAME", help="a benchmark of the list below")
    parser.add_argument("--json", action="store_true", help="print one line of JSON per benchmark")
    parser.add_argument("--worlds", type=int, metavar="N", help="how many random worlds fidelity counts")
    arguments = parser.parse_args()
    if arguments.worlds is not None and arguments.worlds < 1:
        parser.error(f"--worlds {arguments.worlds}; accepted: at least 1")
    if unknown := [name for name in arguments.names if name not in BENCHMARKS]:
        parser.error(f"no benchmark {unknown[0]!r}; accepted: {', '.join(BENCHMARKS)}")
    run_all(tuple(arguments.names), as_json=arguments.json, worlds=arguments.worlds)


if __name__ == "__main__":
    main()
