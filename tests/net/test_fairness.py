"""The record of fairness: what it counts of a frame, when a new one begins, and that any order is found again."""

import contextlib
import socket
from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
import pytest
from msgspec.structs import replace

from tests.net.test_sending_order import order_by_the_protocol
from tests.protocol.samples import BOOT
from vision_core.clock import Instant, after
from vision_core.net.delivery import Batch, DeliveryTable
from vision_core.net.delivery_rows import new_rows
from vision_core.net.fairness import FairnessRecord, lag_bin
from vision_core.protocol.options import PAPER_OPTIONS
from vision_core.settings.schema import MatchSettings
from vision_core.timing.histogram import bin_of
from vision_core.types.fairness import (
    MATCH,
    MAX_ROBOTS,
    PRACTICE,
    REQUEST,
    fairness_from,
    places_of,
    robot_index,
    robot_of,
)
from vision_core.types.objects import Team
from vision_core.types.tables import Table
from vision_core.venues.loader import load_settings

NOWHERE = -1
SEED = 99
ROBOTS = [robot_index(team, number) for team in Team for number in (1, 2, 3)]


@dataclass
class Rig:
    """Three robots of each team."""

    table: DeliveryTable
    frame: int = 0

    def send(self, robots: list[int]) -> list[int]:
        """Send one frame to some robots; returns them in the order of sending."""
        self.frame += 1
        at = after(BOOT, 0.01 * self.frame)
        texts = [b"see" if robot in robots else b"" for robot in ROBOTS]
        count, _ = self.table.send(at, Batch.of(texts))
        return [ROBOTS[row] for row in self.table.order[:count]]

    @property
    def record(self) -> Table:
        row: Table = self.table.fairness.table[0]
        return row


@pytest.fixture
def rig() -> Iterator[Rig]:
    with contextlib.ExitStack() as stack:
        table = DeliveryTable(BOOT, SEED)
        table.replace(new_rows(len(ROBOTS)))
        for row, robot in enumerate(ROBOTS):
            own, other = socket.socketpair(socket.AF_UNIX, socket.SOCK_DGRAM)
            stack.enter_context(other)
            stack.enter_context(own)
            table.address(row, robot, own.fileno(), PAPER_OPTIONS)
        yield Rig(table)


def match_settings(**changes: object) -> MatchSettings:
    return replace(load_settings().match, **changes)


def test_any_frame_s_order_is_found_again(rig: Rig) -> None:
    some = [ROBOTS[0], ROBOTS[2], ROBOTS[5]]
    sent = [(robots, rig.send(robots)) for robots in (ROBOTS, some, ROBOTS, ROBOTS[:1], some)]
    for frame, (robots, order) in reversed(list(enumerate(sent, 1))):
        again = order_by_the_protocol(int(rig.record["seed"]), 10_000 * frame, len(robots))
        assert order == [robots[place] for place in again]


def test_places_are_counted_apart_for_each_number_of_datagrams(rig: Rig) -> None:
    some = [ROBOTS[0], ROBOTS[1], ROBOTS[4]]
    expected = {robot: {3: [0] * 3, 6: [0] * 6} for robot in ROBOTS}
    for robots in (ROBOTS, some, some, ROBOTS, some):
        for place, robot in enumerate(rig.send(robots)):
            expected[robot][len(robots)][place] += 1
    for robot in ROBOTS:
        for count in (3, 6):
            assert places_of(rig.record["robots"][robot], count).tolist() == expected[robot][count]
    assert rig.record["frames"][[3, 6]].tolist() == [3, 2]
    assert rig.record["blue"][[3, 6]].tolist() == [3 * 2, 2 * 3]
    assert rig.record["blue2"][[3, 6]].tolist() == [3 * 4, 2 * 9]


def test_lags_are_those_of_the_rows(rig: Rig) -> None:
    lags_us: dict[int, list[float]] = {robot: [] for robot in ROBOTS}
    differences, squares = [], 0.0
    for _ in range(50):
        rig.send(ROBOTS)
        rows = rig.table.rows
        frame_us = (rows["sent_at"] - rows["grabbed_at"]) / 1000.0
        for robot, lag_us in zip(ROBOTS, frame_us.tolist(), strict=True):
            lags_us[robot].append(lag_us)
        differences.append(frame_us[:3].mean() - frame_us[3:].mean())
        squares += ((frame_us - frame_us.mean()) ** 2).sum()
    record = rig.record
    for robot, lags in lags_us.items():
        served = record["robots"][robot]
        assert served["sent"] == 50
        assert served["lag_us_sum"] == pytest.approx(sum(lags))
        assert served["lag_us2_sum"] == pytest.approx(sum(lag * lag for lag in lags))
        bins = [bin_of(round(lag * 1000)) for lag in lags]
        assert served["lags"].tolist() == np.bincount(bins, minlength=len(served["lags"])).tolist()
    assert record["compared"] == 50
    assert record["difference_us_sum"] == pytest.approx(sum(differences), rel=1e-6, abs=1e-3)
    assert record["difference_us2_sum"] == pytest.approx(sum(d * d for d in differences), rel=1e-6)
    assert record["spread_freedom"] == 50 * 5
    assert record["spread_us2_sum"] == pytest.approx(squares, rel=1e-6)


def test_a_dropped_datagram_has_a_place_and_no_lag(rig: Rig) -> None:
    rig.table.address(0, ROBOTS[0], NOWHERE, PAPER_OPTIONS)
    rig.send(ROBOTS)
    gone = rig.record["robots"][ROBOTS[0]]
    assert (gone["sent"], gone["dropped"], gone["lags"].sum(), gone["places"].sum()) == (0, 1, 0, 1)
    assert rig.record["spread_freedom"] == 4


def test_a_session_is_counted_once_in_each_record(rig: Rig) -> None:
    rig.send(ROBOTS)
    rig.send(ROBOTS)
    assert rig.record["robots"]["sessions"][ROBOTS].tolist() == [1] * 6
    rig.table.rows[2] = new_rows(1)[0]  # another client for this robot
    rig.table.address(2, ROBOTS[2], NOWHERE, PAPER_OPTIONS)
    rig.send(ROBOTS)
    assert rig.record["robots"]["sessions"][ROBOTS].tolist() == [1, 1, 2, 1, 1, 1]


def test_an_empty_frame_and_one_for_too_many_count_nothing() -> None:
    table = DeliveryTable(BOOT, SEED)
    table.replace(new_rows(MAX_ROBOTS + 1))
    table.rows["descriptor"] = NOWHERE
    table.send(after(BOOT, 1.0), Batch.of([b""] * (MAX_ROBOTS + 1)))
    table.send(after(BOOT, 2.0), Batch.of([b"see"] * (MAX_ROBOTS + 1)))
    assert table.fairness.table["frames"].sum() == 0


@pytest.mark.parametrize("lag_ns", [-5, 0, 1023, 1024, 1055, 1056, 33_333_333, 2**34 - 1, 2**34, 2**62 + 1, 2**63 - 1])
def test_bins_are_those_of_the_histograms(lag_ns: int) -> None:
    assert lag_bin(lag_ns) == bin_of(lag_ns)


def test_a_record_goes_on_until_a_match_begins_or_ends_or_others_play() -> None:
    record, practice, now = FairnessRecord(BOOT), match_settings(mode="practice"), BOOT
    match = match_settings(mode="match", blue_name="Köln", yellow_name="x" * 70)
    steps = [
        (practice, PRACTICE, True),
        (practice, PRACTICE, False),
        (match, MATCH, True),
        (replace(match, play_mode="pause"), MATCH, False),
        (replace(match, blue_name="Graz"), MATCH, True),
        (practice, PRACTICE, True),
    ]
    for step, (settings, reason, begins) in enumerate(steps):
        now = after(now, 1.0)
        record.table["frames"][0, 2] = 7
        ended = record.follow(settings, Instant(0), now, 1000.0 + step)
        assert (ended is not None) == begins
        if ended is not None:
            old = fairness_from(ended)[0]
            assert (old["frames"][2], old["ended_s"]) == (7, 1000.0 + step)
            assert record.table["frames"].sum() == 0
            assert record.table["seed"][0] != old["seed"]
        assert record.table["reason"][0] == reason


def test_names_are_cut_between_letters() -> None:
    record = FairnessRecord(BOOT)
    match = match_settings(blue_name="ö" * 40)
    record.follow(match, Instant(0), BOOT, 1.0)
    assert record.table["blue_name"][0].decode() == "ö" * 32
    record.table["frames"][0, 2] = 1
    assert record.follow(match, Instant(0), after(BOOT, 1.0), 2.0) is None


def test_the_operator_begins_a_new_record_once() -> None:
    record, practice = FairnessRecord(BOOT), match_settings(mode="practice")
    record.follow(practice, Instant(0), BOOT, 1.0)
    record.table["frames"][0, 2] = 1
    asked = after(BOOT, 5.0)
    assert record.follow(practice, asked, after(asked, 0.1), 6.0) is not None
    assert record.table["reason"][0] == REQUEST
    record.table["frames"][0, 2] = 1
    assert record.follow(practice, asked, after(asked, 0.2), 7.0) is None


def test_a_record_without_a_frame_is_dropped() -> None:
    record = FairnessRecord(BOOT)
    assert record.follow(match_settings(mode="practice"), Instant(0), BOOT, 1.0) is None
    assert record.follow(match_settings(mode="match"), Instant(0), BOOT, 2.0) is None


def test_a_successor_goes_on_with_the_record_of_its_boot_only() -> None:
    first = FairnessRecord(BOOT)
    first.follow(match_settings(mode="match"), Instant(0), BOOT, 1.0)
    first.table["frames"][0, 5] = 8
    successor, stranger = FairnessRecord(BOOT), FairnessRecord(after(BOOT, 1.0))
    for each in (successor, stranger):
        each.load(bytes(first.memory))
    assert np.array_equal(successor.table, first.table)
    assert not stranger.has_begun
    with pytest.raises(ValueError, match="buffer"):
        successor.load(b"short")


def test_every_robot_has_an_index_of_its_own() -> None:
    robots = [(team, number) for team in Team for number in range(1, 17)]
    assert [robot_of(robot_index(*robot)) for robot in robots] == robots
    assert sorted(robot_index(*robot) for robot in robots) == list(range(MAX_ROBOTS))
