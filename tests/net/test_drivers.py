"""The record of what drivers ask for."""

from tests.protocol.samples import BOOT, CLIENT, MAIN
from vision_core.clock import after
from vision_core.net.drivers import Drivers
from vision_core.protocol.driving import Drive
from vision_core.protocol.events import Driven, Reply, SessionClosed
from vision_core.protocol.lifecycle import Session, SessionState, SessionTrigger
from vision_core.protocol.messages import Init
from vision_core.types.drives import Drives, drives_from
from vision_core.types.objects import Team

NOW = after(BOOT, 1.0)
LATER = after(BOOT, 1.1)


def session(team: Team = Team.YELLOW, number: int = 4) -> Session:
    return Session(Init(team, number), False, CLIENT, "127.0.0.1", BOOT, SessionState.SETTLED, BOOT, BOOT)


def rows(drivers: Drivers) -> Drives:
    return drives_from(drivers.record)


def test_the_newest_command_stands_in_the_robots_row() -> None:
    drivers, robot = Drivers(), session()
    assert drivers.note([Driven(robot, Drive(0.5, 0.1, -2.0, 3.0, True), NOW)])
    assert drivers.note([Driven(robot, Drive(0.4), LATER)])
    row = rows(drivers)[1, 3]
    assert (row["at"], row["vx_m_s"], row["vy_m_s"], row["turn_rad_s"], row["dribbles"]) == (LATER, 0.4, 0.0, 0.0, 0)
    assert (row["kicked_at"], row["kick_m_s"]) == (NOW, 3.0)  # a kick is not lost by the command that follows it
    assert (rows(drivers)["at"] != 0).sum() == 1


def test_other_events_change_nothing() -> None:
    assert not Drivers().note([Reply(b"(pong)", CLIENT, MAIN), SessionClosed(session(), SessionTrigger.LEFT)])


def test_the_row_is_empty_when_the_session_has_ended() -> None:
    drivers, robot = Drivers(), session()
    drivers.note([Driven(robot, Drive(0.5), NOW)])
    assert drivers.note([SessionClosed(robot, SessionTrigger.SILENT)])
    assert not rows(drivers)["at"].any()


def test_a_successor_goes_on_with_the_drivers_whose_sessions_go_on() -> None:
    drivers, stays, goes = Drivers(), session(), session(Team.BLUE, 1)
    drivers.note([Driven(stays, Drive(0.5), NOW), Driven(goes, Drive(0.6), NOW)])
    row = rows(Drivers([stays], drivers.record))
    assert (row[1, 3]["vx_m_s"], row[0, 0]["at"]) == (0.5, 0)
