"""``pslv conformance``: our server keeps every rule."""

import json
from pathlib import Path

import pytest

from tests.client.fake import ScriptedServer
from tests.examination.hall import Hall
from tests.net.serving import running
from vision_core.examination.__main__ import main
from vision_core.examination.conformance.examine import RULES, examine
from vision_core.examination.conformance.probe import Probe
from vision_core.examination.conformance.rule import Verdict
from vision_core.examination.findings import Grade
from vision_core.examination.way import place_of

pytestmark = pytest.mark.slow

PAGE = " ".join((Path(__file__).parents[2] / "docs" / "protocol.md").read_text(encoding="utf-8").split())


@pytest.fixture(autouse=True)
def no_long_silences(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("vision_core.examination.conformance.probe.QUIET_S", 0.1)


def test_the_page_says_every_sentence() -> None:
    assert [rule.name for rule in RULES if rule.sentence not in PAGE] == []
    assert len({rule.name for rule in RULES}) == len(RULES)


def test_our_server_keeps_every_rule() -> None:
    hall = Hall()
    with running(hall):
        found = list(examine(Probe(place_of("127.0.0.1", hall.port))))
    hall.close()
    assert [(one.rule.name, one.why, one.exchange) for one in found if one.verdict is not Verdict.PASSED] == []
    assert len(found) == len(RULES)


def test_robots_that_nobody_drives_are_refused_by_name() -> None:
    hall = Hall(drives=False)
    with running(hall):
        drives = [rule for rule in RULES if rule.name.startswith("a-drive")]
        (found,) = examine(Probe(place_of("127.0.0.1", hall.port)), drives)
    hall.close()
    assert (found.verdict, found.why) == (Verdict.PASSED, "")


def test_what_cannot_be_seen_is_skipped(capsys: pytest.CaptureFixture[str]) -> None:
    with ScriptedServer(lambda _: [b"(error not_admitted)"]) as server:
        words = ["conformance", "--port", str(server.port), "--only", "time-grows", "--json"]
        assert main(words) == Grade.DOUBTFUL
    told = json.loads(capsys.readouterr().out)
    assert (told["verdict"], told["why"]) == ("skipped", "the session was not opened: (error not_admitted)")


def test_the_command_says_what_was_sent_and_what_came(capsys: pytest.CaptureFixture[str]) -> None:
    with ScriptedServer(lambda _: [b"(error not_admitted)"]) as server:
        assert (
            main(["conformance", "--port", str(server.port), "--only", "unknown-options-are-illegal-in-version-1"]) == 2
        )
    lines = capsys.readouterr().out.splitlines()
    assert lines[0].startswith("failed   unknown-options-are-illegal-in-version-1: ")
    assert "in version 1 they are illegal" in lines[1]
    assert lines[2].endswith("<- (init blue 1 (novelty 1))")
    assert lines[-1] == "0 passed, 1 failed, 0 skipped"
