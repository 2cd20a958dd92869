"""A measured cause is reported when it has lasted and stays until it has been absent for a while."""

from dataclasses import replace

from app.web.health.cause import Cause, Subject
from app.web.health.hysteresis import RELEASE_S, Hysteresis
from vision_core.clock import Instant, after

START = Instant(1_000_000_000_000)
MEASURED = Cause("rate", Subject.CAMERA, "slow", "Hurry.", hold_s=2.0)
DISCRETE = Cause("off", Subject.SERVICE, "switched off", "Switch it on.")


def reported(hysteresis: Hysteresis, at_s: float, *present: Cause) -> list[str]:
    """Texts that are reported at an instant [s since START]."""
    return [cause.text for cause in hysteresis.filtered(present, after(START, at_s))]


def test_a_discrete_cause_comes_and_goes_at_once() -> None:
    hysteresis = Hysteresis()
    assert reported(hysteresis, 0.0, DISCRETE) == ["switched off"]
    assert reported(hysteresis, 0.1) == []


def test_a_measured_cause_has_to_last() -> None:
    hysteresis = Hysteresis()
    assert reported(hysteresis, 0.0, MEASURED) == []
    assert reported(hysteresis, 1.9, MEASURED) == []
    assert reported(hysteresis, 2.0, MEASURED) == ["slow"]


def test_a_cause_that_comes_and_goes_is_one_steady_message() -> None:
    hysteresis = Hysteresis()
    messages = [reported(hysteresis, 0.5 * turn, *([MEASURED] if turn % 3 == 0 else [])) for turn in range(40)]
    assert messages[:6] == [[]] * 6
    assert messages[6:] == [["slow"]] * 34


def test_a_cause_is_released_after_its_absence() -> None:
    hysteresis = Hysteresis()
    for at_s in (0.0, 2.0):
        reported(hysteresis, at_s, MEASURED)
    assert reported(hysteresis, 2.0 + RELEASE_S) == ["slow"]
    assert reported(hysteresis, 2.1 + RELEASE_S) == []
    assert reported(hysteresis, 2.2 + RELEASE_S, MEASURED) == [], "it has to last anew"


def test_the_newest_numbers_are_reported_in_the_order_of_the_snapshot() -> None:
    hysteresis = Hysteresis()
    reported(hysteresis, 0.0, DISCRETE, MEASURED)
    newest = replace(MEASURED, text="slower")
    assert reported(hysteresis, 2.0, newest, DISCRETE) == ["slower", "switched off"]
