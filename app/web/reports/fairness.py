"""The impartiality report of a match. It tells no positions: everybody may read it."""

import hashlib
from typing import Any, Literal

import numpy as np

from app.web.fairness.distributions import lag_bins_ms, mean_place, place_shares
from app.web.fairness.statistics import (
    LagTest,
    OrderTest,
    PlacesTest,
    lag_test,
    order_test,
    robot_places,
    team_places,
)
from app.web.fairness.verdict import Judgment, verdict_of
from app.web.reports.base import Report
from vision_core.clock import MS_PER_S, US_PER_S
from vision_core.timing.histogram import quantile_s
from vision_core.types.fairness import MATCH, MAX_ROBOTS, PRACTICE, REQUEST, robot_of
from vision_core.types.objects import Team
from vision_core.types.tables import MAX_NUMBERS, TEAM_NUMBER, TEAMS, Table

US_PER_MS = US_PER_S / MS_PER_S
REASONS: dict[int, Literal["practice", "match", "request"]] = {
    PRACTICE: "practice",
    MATCH: "match",
    REQUEST: "request",
}


class RecordReport(Report):
    """What was recorded, and when."""

    reason: Literal["practice", "match", "request"]
    """Why it began: nothing else was going on, a match began, or the operator asked for it."""
    is_match: bool
    began_s: float
    """Seconds since 1970."""
    ended_s: float | None
    """null: it goes on."""
    frames: int
    """Frames of which at least one client was sent a view."""
    seed_sha256: str
    """SHA-256 of the 16 hexadecimal digits of the seed of the order of sending."""
    seed: str | None
    """These digits: with them anybody can find the order of any frame again; null while the record goes on."""


class ServedReport(Report):
    """How a robot or a team was served."""

    sent: int
    """Datagrams."""
    dropped: int
    """Datagrams that the network refused."""
    mean_place: float
    """Mean place in the order of sending, 0 first .. 1 last; 0.5 is fair."""
    lag_mean_ms: float | None
    """From the grab of the image until the datagram was sent; null without datagrams."""
    lag_p50_ms: float | None
    lag_p99_ms: float | None


class RobotFairness(ServedReport):
    """How one robot was served, over all its sessions."""

    team: Team
    number: int
    sessions: int
    chi_square: float
    """Of its places, against every place as often as any other."""
    freedom: int
    p: float
    """Probability of such a chi-square in a random order, adjusted for the number of robots."""


class TeamFairness(ServedReport):
    """How one team was served."""

    team: Team
    name: str
    """Of the team that played this color when the record began."""
    robots: int
    """That were sent a view at least once."""
    place_shares: list[float]
    """Shares of its datagrams in each tenth of the order of sending, first to last."""
    lag_bins: list[tuple[float, int]]
    """Upper end [ms] and count of each bin of lags that is not empty."""


class OrderReport(Report):
    """Whether one team is sent its views before the other: of all pairs of their datagrams in the same frame."""

    pairs: int
    blue_first: float
    """Share in which blue's was sent first; 0.5 is fair."""
    limit: float | None
    """A random order gives one half, and at most so much more or less; null without pairs."""
    z: float
    p: float


class PlacesReport(Report):
    """Chi-square of the teams' places in the order of sending."""

    chi_square: float
    freedom: int
    p: float
    deviation: float
    """The largest relative difference of a place's count from the expected one."""


class LagDifferenceReport(Report):
    """Blue's mean lag minus yellow's, within the same frame."""

    frames: int
    """That were sent to both teams."""
    difference_us: float
    error_us: float | None
    """Its standard error; null without frames."""
    spread_us: float
    """Standard deviation of the lags of a frame's datagrams."""
    share: float
    """The difference as a share of the spread."""
    limit: float | None
    """The true share is at most so far away; null without frames."""
    p: float


class FairnessReport(Report):
    """Whether both teams were served alike."""

    verdict: Judgment
    """impartial, biased, or not_proven: too few frames."""
    reasons: list[str]
    """In words, with the limits."""
    record: RecordReport
    teams: list[TeamFairness]
    robots: list[RobotFairness]
    """That were sent a view at least once."""
    order: OrderReport
    places: PlacesReport
    lag: LagDifferenceReport


def fairness_report(record: Table, *, tells_seed: bool = False) -> FairnessReport:
    """The report of a record. record: a row of FAIRNESS; tells_seed: also while the record goes on."""
    order, teams, robots, lag = order_test(record), team_places(record), robot_places(record), lag_test(record)
    verdict = verdict_of(order, teams, robots, lag)
    return FairnessReport(
        verdict=verdict.judgment,
        reasons=list(verdict.reasons),
        record=_record_report(record, tells_seed=tells_seed),
        teams=[_team_report(record, team) for team in TEAMS],
        robots=_robot_reports(record, robots),
        order=_order_report(order),
        places=PlacesReport(chi_square=teams.chi_square, freedom=teams.freedom, p=teams.p, deviation=teams.deviation),
        lag=_lag_report(lag),
    )


def _record_report(record: Table, *, tells_seed: bool) -> RecordReport:
    seed, ended_s = f"{int(record['seed']):016x}", float(record["ended_s"])
    return RecordReport(
        reason=REASONS[int(record["reason"])],
        is_match=bool(record["is_match"]),
        began_s=float(record["began_s"]),
        ended_s=ended_s or None,
        frames=int(record["frames"].sum()),
        seed_sha256=hashlib.sha256(seed.encode()).hexdigest(),
        seed=seed if ended_s or tells_seed else None,
    )


def _team_report(record: Table, team: Team) -> TeamFairness:
    first = TEAM_NUMBER[team] * MAX_NUMBERS
    robots = record["robots"][first : first + MAX_NUMBERS]
    return TeamFairness(
        team=team,
        name=bytes(record[f"{team}_name"]).decode(),
        robots=int(robots["places"].any(axis=1).sum()),
        place_shares=place_shares(robots).tolist(),
        lag_bins=lag_bins_ms(robots["lags"].sum(axis=0, dtype=np.uint64)),
        **_served(robots),
    )


def _robot_reports(record: Table, tests: list[PlacesTest]) -> list[RobotFairness]:
    by_name = {test.who: test for test in tests}
    found = []
    for index in range(MAX_ROBOTS):
        team, number = robot_of(index)
        test = by_name.get(f"{team} {number}")
        if test is not None:
            robots = record["robots"][index : index + 1]
            found.append(
                RobotFairness(
                    team=team,
                    number=number,
                    sessions=int(robots["sessions"][0]),
                    chi_square=test.chi_square,
                    freedom=test.freedom,
                    p=test.p,
                    **_served(robots),
                )
            )
    return found


def _served(robots: Table) -> dict[str, Any]:
    """The fields of ServedReport. robots: SERVED, shape (n,)."""
    sent, lags = int(robots["sent"].sum()), robots["lags"].sum(axis=0, dtype=np.uint64)
    p50_s, p99_s = (quantile_s(lags, share) for share in (0.5, 0.99))
    return {
        "sent": sent,
        "dropped": int(robots["dropped"].sum()),
        "mean_place": mean_place(robots),
        "lag_mean_ms": float(robots["lag_us_sum"].sum()) / sent / US_PER_MS if sent else None,
        "lag_p50_ms": None if p50_s is None else p50_s * MS_PER_S,
        "lag_p99_ms": None if p99_s is None else p99_s * MS_PER_S,
    }


def _order_report(order: OrderTest) -> OrderReport:
    return OrderReport(
        pairs=order.pairs,
        blue_first=order.blue_first,
        limit=order.limit if order.pairs else None,
        z=order.z,
        p=order.p,
    )


def _lag_report(lag: LagTest) -> LagDifferenceReport:
    is_known = lag.spread_us > 0.0
    return LagDifferenceReport(
        frames=lag.frames,
        difference_us=lag.difference_us,
        error_us=lag.error_us if is_known else None,
        spread_us=lag.spread_us,
        share=lag.share,
        limit=lag.limit if is_known else None,
        p=lag.p,
    )
