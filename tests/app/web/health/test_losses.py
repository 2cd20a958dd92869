"""What was lost in the last minute is counted from increasing counters, and reported when it is much."""

from dataclasses import replace

from app.web.blackboard import ServiceSnapshot
from app.web.health.cause import Subject
from app.web.health.losses import WINDOW_S, LastMinute, Losses, loss_causes
from tests.app.fake_snapshot import serving_snapshot, task_report, timed, with_records
from tests.app.fake_tasks import Condition, clients_of
from vision_core.clock import Instant, after
from vision_core.rtdb.infos import Serving

WELL = serving_snapshot()


def at(seconds: float, missed: int = 0, pid: int = 1, dropped: int = 0, overruns: int = 0) -> ServiceSnapshot:
    """A snapshot of some instant, with counts since the start of their processes and sessions."""
    perceive = task_report("perceive", missed=missed, overruns=overruns, pid=pid)
    (client,) = clients_of(Condition(), 1, 1, 9, Instant(5))
    serving = timed(Serving((replace(client, dropped=dropped),), 0.0, 0.0, ()))
    counted = replace(with_records(WELL, serving=serving), tasks={"perceive": perceive})
    return replace(counted, now=after(WELL.now, seconds))


def test_what_was_lost_before_the_first_look_does_not_count() -> None:
    assert LastMinute().losses(at(0.0, missed=70, dropped=8)) == Losses()


def test_what_is_lost_counts_for_a_minute() -> None:
    minute = LastMinute()
    minute.losses(at(0.0, missed=70))
    assert minute.losses(at(5.0, missed=73, dropped=2, overruns=1)).missed == {"perceive": 3}
    losses = minute.losses(at(30.0, missed=73, dropped=2, overruns=1))
    assert (losses.missed, losses.overruns, losses.dropped) == ({"perceive": 3}, {"perceive": 1}, {"blue 1": 2})
    assert minute.losses(at(6.0 + WINDOW_S, missed=73, dropped=2, overruns=1)) == Losses()


def test_a_process_that_was_replaced_counts_from_nothing() -> None:
    minute = LastMinute()
    minute.losses(at(0.0, missed=70))
    assert minute.losses(at(2.0, missed=4, pid=2)).missed == {"perceive": 4}


def causes(losses: Losses) -> list[Subject]:
    return [cause.about for cause in loss_causes(WELL, losses)]


def test_the_occasional_loss_is_no_cause() -> None:
    few = Losses()
    few.missed["perceive"] = few.dropped["blue 1"] = 3
    assert causes(few) == []


def test_many_losses_are_causes_that_name_where() -> None:
    many = Losses()
    many.missed["perceive"], many.overruns["perceive"], many.dropped["blue 1"] = 30, 5, 40
    misses, drops = loss_causes(WELL, many)
    assert (misses.about, drops.about) == (Subject.MISSES, Subject.DROPS)
    assert misses.sentence == "35 times in the last minute a task was late or skipped an image: perceive 35"
    assert drops.sentence == "40 datagrams were dropped in the last minute: blue 1 40"


def test_a_task_without_urgency_may_skip_images() -> None:
    idle = Losses()
    idle.missed["diagnose"] = 500
    assert causes(idle) == []
