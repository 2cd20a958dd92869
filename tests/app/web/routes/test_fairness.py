"""The impartiality report: for everybody to read, for the operator to begin anew, kept when a match ends."""

import json
from collections.abc import Iterator
from pathlib import Path

import httpx
import pytest

from app.web.blackboard import Blackboard
from app.web.fairness.keeper import FairnessKeeper
from app.web.fairness.kept import KeptReports
from tests.app.fake_service import FakeService, Scene, asked_by_operator, served_page, wait_for
from tests.app.web.fairness.simulated import record_of
from vision_core.clock import Instant
from vision_core.rtdb import records
from vision_core.types.fairness import PRACTICE


def database_of(service: FakeService) -> Path:
    return Path(records.SERVICE.reader(service.store).value(Instant(0)).database)


@pytest.fixture
def service() -> Iterator[FakeService]:
    made = FakeService(Scene(clients=10))
    made.write_frame()
    yield made
    made.stop()


def test_everybody_reads_the_report(service: FakeService) -> None:
    with served_page(service) as address, httpx.Client(base_url=f"http://{address}") as viewer:
        report = viewer.get("/api/v1/fairness")
        assert report.status_code == 200
        assert report.json()["record"]["frames"] == 600
        assert [team["team"] for team in report.json()["teams"]] == ["blue", "yellow"]
        assert len(report.json()["robots"]) == 10
        assert "x_m" not in report.text
        html = viewer.get("/api/v1/fairness.html")
        assert html.text.startswith("<!doctype html>")
        assert "default-src 'none'" in html.headers["content-security-policy"]
        assert viewer.get("/api/v1/fairness.png").content.startswith(b"\x89PNG")
        missing = viewer.get("/api/v1/fairness", params={"record": "../people"})
        assert (missing.status_code, missing.json()["field"]) == (404, "record")
        assert viewer.post("/api/v1/fairness/new", json={}).status_code == 401


def test_the_seed_of_a_record_that_goes_on_is_on_disk_and_told_to_nobody(service: FakeService) -> None:
    with asked_by_operator(service) as operator:
        wait_for(lambda: operator.get("/fairness/kept").json())
        (name,) = (each["name"] for each in operator.get("/fairness/kept").json())
        assert KeptReports(database_of(service)).read(name).record.seed == "0000000000000007"
        assert operator.get("/fairness", params={"record": name}).json()["record"]["seed"] is None
        running = record_of(50)
        running["began_s"] += 1000.0
        now = service.clock.now()
        service.store.writer(records.FAIRNESS_RECORD.name).write(running.tobytes(), now, now)
        assert operator.get("/fairness", params={"record": name}).json()["record"]["seed"] == "0000000000000007"


def test_the_operator_begins_a_new_record(service: FakeService) -> None:
    with asked_by_operator(service) as operator:
        before = records.LIVE_SETTINGS.reader(service.store).value(Instant(0))
        assert operator.post("/fairness/new", json={}).status_code == 202
        after = records.LIVE_SETTINGS.reader(service.store).value(Instant(0))
    assert after.fairness_asked > before.fairness_asked
    assert after.match == before.match


def test_what_has_ended_is_kept_once_and_practice_is_not(service: FakeService, tmp_path: Path) -> None:
    kept = KeptReports(tmp_path / "venue.db")
    keeper = FairnessKeeper(Blackboard(service.store), kept)
    keeper.keep_ended()
    assert kept.names() == []
    practice, match = record_of(50), record_of(60)
    practice["reason"] = PRACTICE
    match["ended_s"] = match["began_s"] + 2.0
    now = service.clock.now()
    for record, count in ((practice, 0), (match, 1), (record_of(0), 1)):
        service.store.writer(records.FAIRNESS_ENDED.name).write(record.tobytes(), now, now)
        keeper.keep_ended()
        assert len(kept.names()) == count
    path = kept.folder / f"{kept.names()[0].name}.json"
    assert json.loads(path.read_text())["record"]["seed"] == "0000000000000007"
    path.unlink()
    keeper.keep_ended()
    assert kept.names() == []
    keeper.keep_running()
    assert len(kept.names()) == 1


def test_a_disk_that_takes_nothing_is_complained_of_once(
    service: FakeService, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    (tmp_path / "fairness").write_text("a file")
    keeper = FairnessKeeper(Blackboard(service.store), KeptReports(tmp_path / "venue.db"))
    for _ in range(3):
        keeper.keep_running()
    assert capsys.readouterr().err.count("warning: impartiality report") == 1
