"""``python -m vision_core.examination``: the commands check, conformance and check-client."""

import argparse
import os
import sys
from collections.abc import Callable, Iterable, Sequence
from typing import TypeAlias, TypeVar

from vision_core.clock import MonotonicClock
from vision_core.errors import ConnectionRefused, PslvError
from vision_core.examination.before_match import Asked, check_server
from vision_core.examination.conformance.examine import RULES, examine, print_outcome
from vision_core.examination.conformance.probe import Probe
from vision_core.examination.conformance.rule import Verdict
from vision_core.examination.findings import Finding, Grade, print_finding, worst
from vision_core.examination.trial.examine import ACTS, examine_client
from vision_core.examination.trial.program import Program
from vision_core.examination.trial.server import TrialServer
from vision_core.examination.way import place_of
from vision_core.protocol.messages import MAX_NUMBER
from vision_core.types.objects import Team

MAX_SECONDS = 3600.0
CHECK = (
    "Connect as a robot, watch its views, and say how ready this computer is. End your own program first: on the same"
    " computer the check takes the robot from it."
)
EXIT_CODES = "Exit code 0: all is good; 1: something is doubtful; 2: something does not work."
Number = TypeVar("Number", int, float)
Commands: TypeAlias = "argparse._SubParsersAction[argparse.ArgumentParser]"


def main(arguments: Sequence[str] | None = None) -> int:
    """Run a command; returns its exit code: the worst grade, 2 also for a command that cannot be carried out."""
    asked = _parser().parse_args(arguments)
    try:
        return int(asked.run(asked))
    except PslvError as error:
        print(f"pslv {asked.command}: {error}", file=sys.stderr)
        return int(Grade.BAD)
    except KeyboardInterrupt:
        return int(Grade.DOUBTFUL)


def _check(asked: argparse.Namespace) -> Grade:
    robot = Asked(asked.host, asked.port, Team(asked.team), asked.number, asked.key)
    return _printed(check_server(robot, MonotonicClock(), seconds=asked.seconds), as_json=asked.json)


def _conformance(asked: argparse.Namespace) -> Grade:
    try:
        place = place_of(asked.host, asked.port)
    except (OSError, UnicodeError) as error:
        raise ConnectionRefused(asked.host, found=str(error), accepted="a name or address of a server") from None
    rules = [rule for rule in RULES if asked.only in (None, rule.name)]
    probe = Probe(place, asked.team, asked.number, asked.other)
    verdicts = []
    for outcome in examine(probe, rules):
        verdicts.append(outcome.verdict)
        print_outcome(outcome, sys.stdout, as_json=asked.json)
    if not asked.json:
        print(", ".join(f"{verdicts.count(verdict)} {verdict}" for verdict in Verdict))
    if Verdict.FAILED in verdicts:
        return Grade.BAD
    return Grade.DOUBTFUL if Verdict.SKIPPED in verdicts else Grade.GOOD


def _check_client(asked: argparse.Namespace) -> Grade:
    words = asked.client[1:] if asked.client[:1] == ["--"] else asked.client
    program = Program(words)
    server = TrialServer(asked.host, asked.port, program, MonotonicClock())
    try:
        if not words:
            print(f"start your client now: it finds a server at {asked.host} port {server.port}", file=sys.stderr)
        acts = [asked.only] if asked.only else []
        return _printed(examine_client(server, acts, wait_s=asked.wait), as_json=asked.json)
    finally:
        program.stop()
        server.close()


def _printed(findings: Iterable[Finding], *, as_json: bool) -> Grade:
    """Print findings as they come; the worst grade."""
    found = []
    for finding in findings:
        found.append(finding)
        print_finding(finding, sys.stdout, as_json=as_json)
    return worst(found)


def _parser() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(prog="pslv", description="Examine a server, a client, or the way between them.")
    commands = parser.add_subparsers(dest="command", required=True)
    _add_check(_command(commands, "check", CHECK))
    conformance = "Hold another server to docs/protocol.md, one rule after the other, from the wire only."
    _add_conformance(_command(commands, "conformance", conformance))
    trial = "Play a server to your client that loses, delays, repeats, restarts, and say what the client does wrong."
    _add_check_client(_command(commands, "check-client", trial))
    return parser


def _add_check_client(parser: argparse.ArgumentParser) -> None:
    parser.set_defaults(run=_check_client)
    parser.add_argument("--host", default="127.0.0.1", help="our address that the client sends to [%(default)s]")
    port_help = "our UDP port; the next one is the session port [%(default)s]"
    parser.add_argument("--port", type=within(int, 1, 65534), default=6000, help=port_help)
    wait_help = "for the client's first datagram, in seconds [%(default)g]"
    parser.add_argument("--wait", type=within(float, 0.1, MAX_SECONDS), default=60.0, help=wait_help)
    parser.add_argument("--only", choices=list(ACTS), metavar="ACT", help=f"play one act only: {', '.join(ACTS)}")
    parser.add_argument("--json", action="store_true", help="one line of JSON per finding")
    client_help = "the client and its words, behind --; without it, start it yourself"
    parser.add_argument("client", nargs=argparse.REMAINDER, help=client_help)


def _add_conformance(parser: argparse.ArgumentParser) -> None:
    parser.set_defaults(run=_conformance)
    _add_server(parser)
    _add_robot(parser)
    other_help = "a second robot of the team; nobody may play either now [%(default)s]"
    parser.add_argument("--other", type=within(int, 1, MAX_NUMBER), default=2, help=other_help)
    parser.add_argument(
        "--only", choices=[rule.name for rule in RULES], metavar="RULE", help="hold it to this rule only"
    )


def _add_robot(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("--team", choices=[team.value for team in Team], default="blue", help="[%(default)s]")
    number_help = f"of the robot, 1..{MAX_NUMBER} [%(default)s]"
    parser.add_argument("--number", type=within(int, 1, MAX_NUMBER), default=1, help=number_help)


def _command(commands: Commands, name: str, description: str) -> argparse.ArgumentParser:
    return commands.add_parser(name, help=description, description=description, epilog=EXIT_CODES)


def _add_check(parser: argparse.ArgumentParser) -> None:
    parser.set_defaults(run=_check)
    _add_server(parser)
    _add_robot(parser)
    key_help = (
        "the team's key, from the referee; others on this computer can read arguments, but not PSLV_KEY [PSLV_KEY]"
    )
    parser.add_argument("--key", default=os.environ.get("PSLV_KEY") or "", help=key_help)
    seconds_help = "for how long views are watched [%(default)g]"
    parser.add_argument("--seconds", type=within(float, 0.1, MAX_SECONDS), default=10.0, help=seconds_help)


def _add_server(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("host", nargs="?", default="127.0.0.1", help="name or address of the server [%(default)s]")
    port = os.environ.get("PSLV_UDP_PORT") or "6000"
    parser.add_argument("--port", type=within(int, 1, 65535), default=port, help="UDP port of the server [%(default)s]")
    parser.add_argument("--json", action="store_true", help="one line of JSON per finding")


def within(kind: Callable[[str], Number], least: float, most: float) -> Callable[[str], Number]:
    """A parser of numbers within limits."""

    def parsed(text: str) -> Number:
        value = kind(text)
        if not least <= value <= most:
            raise argparse.ArgumentTypeError(f"{text} is not within {least:g}..{most:g}")
        return value

    return parsed


if __name__ == "__main__":
    sys.exit(main())
