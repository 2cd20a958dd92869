"""Colors found in pictures: on rendered fields with papers that nobody has named."""

from dataclasses import replace

import numpy as np
import pytest

from tests.palette.rendered import other_paper, papers, rendered, right_and_wrong
from vision_core.color.samples import Measured
from vision_core.palette.find import find_colors, find_palette
from vision_core.palette.light import light_from
from vision_core.palette.reading import cells_of, judged_with
from vision_core.palette.result import result_of
from vision_core.palette.starts import FIRST
from vision_core.palette.trial import Trial
from vision_core.patterns.paints import PAINTS_BGR
from vision_core.venues.loader import load_settings

pytestmark = pytest.mark.timeout(600)  # the first test may compile the hot path


@pytest.mark.parametrize(("venue", "seed"), [("demo-vsss", 1), ("demo-vsss", 2), (None, 3)])
def test_papers_of_other_suppliers_are_found(venue: str | None, seed: int, monkeypatch: pytest.MonkeyPatch) -> None:
    settings = load_settings(venue)
    shown = rendered(settings, papers(seed), monkeypatch, 3)
    trial = Trial(settings, light_from(shown[0][0], settings))
    pictures = [trial.prepared(pixels) for pixels, _ in shown]
    found = find_palette(trial, pictures[:2])
    trial.use(found.table)
    scores = [right_and_wrong(trial.judge(picture), truth) for picture, (_, truth) in zip(pictures, shown, strict=True)]
    true, right, wrong = (sum(column) for column in zip(*scores, strict=True))
    assert wrong == 0
    assert right >= 0.9 * true


def test_the_result_is_a_venue_s_colors_and_says_what_was_not_seen(monkeypatch: pytest.MonkeyPatch) -> None:
    settings = load_settings("demo-vsss")
    ((pixels, _),) = rendered(settings, PAINTS_BGR, monkeypatch, 1)
    said: list[str] = []
    found = find_colors([pixels], settings, lambda share, what: said.append(f"{share:.1f} {what}"))
    assert found.accepted
    assert set(found.colors.samples) == {*(paint.name for paint in found.paints), "none"}
    assert not found.colors.classes
    assert found.pictures[0].robots == 6
    unseen = [paint.name for paint in found.paints if not paint.patches]
    assert all(any(name in str(reason) for reason in found.reasons) for name in unseen)
    assert said[0].startswith("0.0 searching for shapes")
    assert "learning from what is read" in said[-1]


def test_papers_that_are_too_alike_are_refused_by_name(monkeypatch: pytest.MonkeyPatch) -> None:
    settings = load_settings("demo-vsss")
    alike = {**PAINTS_BGR, "magenta": other_paper(PAINTS_BGR["red"], -4.0, 1.0)}
    shown = rendered(settings, alike, monkeypatch, 2)
    found = find_colors([pixels for pixels, _ in shown], settings)
    assert any("magenta" in str(reason) for reason in found.refused), (found.reasons, found.pictures, found.paints)


def test_a_picture_without_robots_is_refused_with_a_reason() -> None:
    settings = load_settings("demo-vsss")
    from vision_core.models.camera_setup import CameraSetup

    found = find_colors([CameraSetup.from_settings(settings).black_image()], settings)
    assert not found.accepted
    assert "no robot's marker is read clearly" in str(found.reasons[0])


def test_guessed_colors_are_refused_and_what_is_not_read_has_its_place(monkeypatch: pytest.MonkeyPatch) -> None:
    settings = load_settings("demo-vsss")
    ((pixels, _),) = rendered(settings, PAINTS_BGR, monkeypatch, 1)
    trial = Trial(settings, light_from(pixels, settings))
    picture = trial.prepared(pixels)
    names = {name: bgr[None] for name, bgr in zip(trial.paints, trial.typical, strict=True)}
    guess = judged_with(trial, [picture], Measured(names, np.zeros((0, 3))), FIRST, cells_of([picture]))
    found = result_of(trial, guess)
    assert found.pictures[0].clear
    assert not found.accepted
    assert "no color was learned: looked for blue" in str(found.refused[0])
    judged = tuple(replace(one, evidence=np.zeros(len(one.robots))) for one in guess.judged)
    unread = result_of(trial, replace(guess, judged=judged))
    x, y = (round(float(judged[0].robots[0][axis])) for axis in ("x_px", "y_px"))
    assert f"looks like a robot with these colors and is not read: at ({x}, {y}) px of picture 1" in str(
        unread.remarks[-1]
    )
    assert "orange could not be learned: 1 ball read, none of them a clear disc" in str(unread.remarks[-2])


@pytest.mark.parametrize(("unread", "expected"), [(0, []), (1, ["yellow: 1 yellow robot without an id may wear it"])])
def test_only_a_robot_of_its_team_may_wear_a_team_s_paint(
    unread: int, expected: list[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    """A blue or a yellow robot has no id, and no picture shows yellow."""
    settings = load_settings("demo-vsss")
    ((pixels, _),) = rendered(settings, PAINTS_BGR, monkeypatch, 1)
    trial = Trial(settings, light_from(pixels, settings))
    picture = trial.prepared(pixels)
    names = {name: bgr[None] for name, bgr in zip(trial.paints, trial.typical, strict=True)}
    guess = judged_with(trial, [picture], Measured(names, np.zeros((0, 3))), FIRST, cells_of([picture]))
    (judged,) = guess.judged
    robots, evidence = judged.robots[:2].copy(), np.array([1.0, 0.0])
    robots["team"] = 0, unread
    counts = np.array([name != "yellow" for name in trial.paints], dtype=np.int64)
    found = result_of(trial, replace(guess, counts=counts, judged=(replace(judged, robots=robots, evidence=evidence),)))
    told = [reason.text.removeprefix("no marker that is read shows ") for reason in found.refused]
    assert [text for text in told if "wear" in text] == expected
