"""The newest view by iteration and by call: none comes late, errors are not lost, and the thread ends."""

import itertools
import threading
import time
from collections.abc import Iterator

import pytest

from tests.client.test_connection import HOST, wait_until
from tests.net.serving import Stadium, playing
from vision_core.client import View, connect
from vision_core.errors import ConnectionRefused
from vision_core.protocol.options import Options


@pytest.fixture
def stadium() -> Iterator[Stadium]:
    with playing(Stadium()) as made:
        yield made


class ControllerError(Exception):
    """A mistake in a program."""


def test_a_slow_program_sees_the_newest_view_each_time(stadium: Stadium) -> None:
    with connect(HOST, stadium.port, "blue", 1) as robot:
        views = []
        for view in robot:
            views.append(view)
            if len(views) == 3:
                break
            time.sleep(0.15)
        following = robot.receive(1.0)
    assert following is not None
    assert views[2].time_s - views[1].time_s > 0.1
    assert following.time_s - views[2].time_s < 0.1


def test_a_function_is_given_views_until_the_connection_is_closed(stadium: Stadium) -> None:
    views: list[View] = []
    with connect(HOST, stadium.port, "blue", 1) as robot:
        thread = robot.on_view(views.append)
        wait_until(lambda: len(views) >= 5)
        with pytest.raises(RuntimeError, match="already"):
            robot.on_view(print)
        assert thread.runs
    assert thread.wait()
    count = len(views)
    times = [view.time_s for view in views]
    assert times == sorted(set(times))
    time.sleep(0.05)
    assert len(views) == count


def fail(view: View) -> None:
    raise ControllerError(f"at {view.time_s}")


def test_an_error_of_the_function_is_logged_and_raised_at_the_end(
    stadium: Stadium, caplog: pytest.LogCaptureFixture
) -> None:
    robot = connect(HOST, stadium.port, "blue", 1)
    thread = robot.on_view(fail)
    wait_until(lambda: not thread.runs)
    assert "ControllerError" in caplog.text
    with pytest.raises(ControllerError):
        thread.wait()
    assert robot.receive(1.0) is not None  # the session goes on without it
    with pytest.raises(ControllerError), robot:
        pass


def test_an_error_of_the_block_is_not_replaced(stadium: Stadium) -> None:
    robot = connect(HOST, stadium.port, "blue", 1)
    thread = robot.on_view(fail)
    wait_until(lambda: not thread.runs)
    with pytest.raises(ZeroDivisionError), robot:
        raise ZeroDivisionError


def test_the_function_itself_may_close_the_connection(stadium: Stadium) -> None:
    robot = connect(HOST, stadium.port, "blue", 1)
    thread = robot.on_view(lambda _: robot.close())
    assert thread.wait(5.0)


def test_a_session_that_is_replaced_ends_the_thread(stadium: Stadium) -> None:
    with connect(HOST, stadium.port, "blue", 1) as robot:
        thread = robot.on_view(lambda _: None)
        other = connect(HOST, stadium.port, "blue", 1)
        with other, pytest.raises(ConnectionRefused, match="replaced"):
            thread.wait(5.0)
        robot._thread = None  # the block's end would raise it again


def test_the_thread_is_a_daemon_with_a_name(stadium: Stadium) -> None:
    names: list[tuple[str, bool]] = []
    with connect(HOST, stadium.port, "blue", 1) as robot:
        robot.on_view(lambda _: names.append((threading.current_thread().name, threading.current_thread().daemon)))
        wait_until(lambda: bool(names))
    assert names[0] == ("pslv views", True)


def test_lags_add_up_to_the_age(stadium: Stadium) -> None:
    with connect(HOST, stadium.port, "blue", 1, options=Options(extras=("age",))) as robot:
        view = next(view for view in itertools.islice(robot, 300) if view.lag is not None)
        time.sleep(0.02)
        robot.receive(1.0)
        used = robot.lag
    assert view.lag is not None
    assert used is not None
    assert view.lag.total_s == pytest.approx(view.age_s, abs=0.02)
    assert view.lag.server_s == view.extras.server_age_s
    assert (used.server_s, used.network_s) == (view.lag.server_s, view.lag.network_s)
    assert used.client_s >= 0.02
    assert abs(view.lag.network_s) <= view.lag.bound_s + 0.01


def test_without_the_extra_there_is_no_lag(stadium: Stadium) -> None:
    with connect(HOST, stadium.port, "blue", 1) as robot:
        assert robot.receive(1.0) is not None
        assert robot.receive(1.0) is not None
        assert robot.lag is None
