"""Holds a server to the rules."""

import json
from collections.abc import Iterator, Sequence
from typing import TextIO

from vision_core.examination.conformance import beyond, commands, opening, ports, version_2, views
from vision_core.examination.conformance.probe import Broken, Probe, Skipped
from vision_core.examination.conformance.rule import Outcome, Rule, Verdict

RULES: tuple[Rule, ...] = tuple(
    rule for module in (opening, ports, views, commands, version_2, beyond) for rule in module.BOOK.rules
)

LAST = 8
"""Datagrams that are shown of a broken rule."""


def examine(probe: Probe, rules: Sequence[Rule] = RULES) -> Iterator[Outcome]:
    """Play the clients of the rules, one after the other."""
    for rule in rules:
        probe.exchange.clear()
        try:
            rule.hold(probe)
            verdict, why = Verdict.PASSED, ""
        except Broken as broken:
            verdict, why = Verdict.FAILED, str(broken)
        except Skipped as skipped:
            verdict, why = Verdict.SKIPPED, str(skipped)
        yield Outcome(rule, verdict, why, tuple(probe.exchange))


def print_outcome(outcome: Outcome, out: TextIO, *, as_json: bool) -> None:
    """One line; for a rule that is broken also the page's sentence and the last datagrams."""
    rule = outcome.rule
    if as_json:
        told = {"rule": rule.name, "sentence": rule.sentence, "verdict": outcome.verdict, "why": outcome.why}
        print(json.dumps({**told, "exchange": outcome.exchange}), file=out, flush=True)
        return
    print(f"{outcome.verdict:<8} {rule.name}{f': {outcome.why}' if outcome.why else ''}", file=out, flush=True)
    if outcome.verdict is Verdict.FAILED:
        lines = [f'the page says: "{rule.sentence}"', *outcome.exchange[-LAST:]]
        print("\n".join(f"           {line}" for line in lines), file=out, flush=True)
