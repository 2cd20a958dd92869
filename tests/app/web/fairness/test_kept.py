"""Reports on disk: what is kept, under which name, and what is not read."""

from pathlib import Path

import pytest

from app.web.fairness.kept import KeptReports, name_of
from app.web.fairness.page import html_of
from app.web.fairness.picture import draw_fairness
from app.web.problems import RequestRefused
from app.web.reports.fairness import fairness_report
from tests.app.web.fairness.simulated import record_of
from vision_core.errors import ServiceError


def test_a_report_is_read_as_it_was_kept(tmp_path: Path) -> None:
    record = record_of(200)
    record["ended_s"] = record["began_s"] + 600.0
    report, kept = fairness_report(record), KeptReports(tmp_path / "venue.db")
    path = kept.keep(report)
    assert path.name.endswith("-graz-b-k-ln.json")
    assert [found.name for found in kept.names()] == [path.stem]
    assert kept.read(path.stem) == report
    assert not list(kept.folder.glob("*.part"))


def test_a_later_report_of_the_same_record_takes_the_place_of_the_earlier(tmp_path: Path) -> None:
    kept = KeptReports(tmp_path / "venue.db")
    for frames in (100, 200):
        path = kept.keep(fairness_report(record_of(frames)))
    assert len(kept.names()) == 1
    assert kept.read(path.stem).record.frames == 200


@pytest.mark.parametrize("name", ["../venue", "20260101-000000", "", "20260101-000000-x/../../y"])
def test_other_files_are_not_read(tmp_path: Path, name: str) -> None:
    (tmp_path / "venue.json").write_text("{}")
    with pytest.raises(RequestRefused):
        KeptReports(tmp_path / "venue.db").read(name)


def test_a_damaged_file_is_refused(tmp_path: Path) -> None:
    kept = KeptReports(tmp_path / "venue.db")
    path = kept.keep(fairness_report(record_of(10)))
    path.write_text(path.read_text()[:300])
    with pytest.raises(RequestRefused):
        kept.read(path.stem)


def test_a_folder_that_cannot_be_made_is_told(tmp_path: Path) -> None:
    (tmp_path / "fairness").write_text("a file")
    with pytest.raises(ServiceError, match="impartiality report"):
        KeptReports(tmp_path / "venue.db").keep(fairness_report(record_of(10)))


def test_the_seed_is_told_when_the_record_has_ended() -> None:
    record = record_of(10)
    running = fairness_report(record).record
    record["ended_s"] = record["began_s"] + 1.0
    ended = fairness_report(record).record
    assert running.seed is None
    assert ended.seed == "0000000000000007"
    assert running.seed_sha256 == ended.seed_sha256


@pytest.mark.parametrize("frames", [0, 300])
def test_html_and_picture_are_whole_and_names_are_text_in_them(frames: int) -> None:
    report = fairness_report(record_of(frames))
    page = html_of(report)
    assert "Graz &lt;b&gt;" in page
    assert "<b>" not in page
    assert page.count("<tr>") == page.count("</tr>") == 4 + len(report.robots)
    picture = draw_fairness(report)
    assert picture.ndim == 3
    assert name_of(report).startswith("2023")
