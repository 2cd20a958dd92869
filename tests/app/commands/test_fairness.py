"""``pslv fairness``: the report in words and as files, what was kept, and a new record."""

import json
from collections.abc import Iterator
from dataclasses import dataclass, replace
from pathlib import Path

import pytest
from typer.testing import CliRunner

from app.cli import app
from app.web.auth.people import People
from app.web.auth.people_file import people_path
from app.web.fairness.kept import KeptReports
from app.web.reports.fairness import fairness_report
from tests.app.fake_service import FakeService, Scene, served_page
from tests.app.web.fairness.simulated import record_of
from vision_core.clock import Instant
from vision_core.errors import PslvError
from vision_core.rtdb import records
from vision_core.rtdb.infos import ServiceInfo
from vision_core.rtdb.store import Store


@dataclass
class Attached:
    """What a command sees of a service."""

    store: Store


@pytest.fixture
def service(monkeypatch: pytest.MonkeyPatch) -> Iterator[FakeService]:
    made = FakeService(Scene(clients=10))
    made.write_frame()
    monkeypatch.setattr("vision_core.net.control.attach_to", lambda _: Attached(made.store))
    yield made
    made.stop()


def info_of(service: FakeService) -> ServiceInfo:
    return records.SERVICE.reader(service.store).value(Instant(0))


def said(*options: str) -> str:
    done = CliRunner().invoke(app, ["fairness", "--service", "pslv/1", *options], catch_exceptions=False)
    assert done.exit_code == 0
    return done.output


def test_the_report_in_words_and_as_files(service: FakeService, tmp_path: Path) -> None:
    json_file, html, picture = tmp_path / "a.json", tmp_path / "a.html", tmp_path / "a.png"
    words = said("--json", str(json_file), "--html", str(html), "--picture", str(picture))
    assert words.startswith("not proven: 600 frames")
    assert "p99 [ms]" in words
    assert "yellow 5" in words
    assert json.loads(json_file.read_text())["record"]["frames"] == 600
    assert html.read_text().startswith("<!doctype html>")
    assert picture.read_bytes().startswith(b"\x89PNG")
    with pytest.raises(PslvError, match="file"):
        said("--json", str(tmp_path))


def test_reports_that_were_kept(service: FakeService) -> None:
    kept = KeptReports(Path(info_of(service).database))
    assert said("--list").startswith("none was kept yet")
    path = kept.keep(fairness_report(record_of(70)))
    assert said("--list").split() == [path.stem]
    assert said("--record", path.stem).startswith("not proven: 70 frames")
    with pytest.raises(PslvError, match=path.stem):
        said("--record", "another")


def test_a_new_record_is_asked_for_as_the_operator_and_no_token_stays(service: FakeService) -> None:
    with served_page(service) as address:
        service.put(records.SERVICE, replace(info_of(service), http=f"http://{address}"))
        assert "a new record begins" in said("--new")
        assert records.LIVE_SETTINGS.reader(service.store).value(Instant(0)).fairness_asked > 0
        people = People(people_path(info_of(service)))
        assert "pslv fairness --new" not in [token.name for token in people.tokens()]
        people.close()


def test_a_page_that_does_not_answer_is_named(service: FakeService) -> None:
    service.put(records.SERVICE, replace(info_of(service), http="http://127.0.0.1:9"))
    with pytest.raises(PslvError, match="a page that answers"):
        said("--new")
