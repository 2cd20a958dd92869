"""The impartiality report as a picture: both teams' places in the order of sending, and their lags."""

import numpy as np

from app.web.charts.panels import BLUE, Panel, Series, draw_panels
from app.web.reports.fairness import FairnessReport, TeamFairness
from vision_core.geometry import Bytes
from vision_core.native.opencv import Color
from vision_core.types.objects import Team

PANEL_PX = 560, 340
LAG_BINS = 28
MOST = 0.999
"""The picture ends where so many of the lags are smaller."""
PARTS = 10_000
"""Shares are drawn in parts of so many."""
COLORS: dict[Team, Color] = {Team.BLUE: BLUE, Team.YELLOW: (60, 210, 235)}


def draw_fairness(report: FairnessReport) -> Bytes:
    """Blue green red, shape (height, width, 3)."""
    tenths = tuple(range(0, 101, 10))
    places = Panel(
        "Place in the order of sending",
        "first 0 % .. last 100 %: a fair order fills every tenth alike",
        tuple(float(tenth) for tenth in tenths),
        tuple(_series(team, [round(PARTS * share) for share in team.place_shares]) for team in report.teams),
        counted="1 / 10 000",
    )
    edges, counts = _lag_counts(report.teams)
    lags = Panel(
        "Lag from the grab of the image to the sending",
        "lag [ms]",
        edges,
        tuple(_series(team, count) for team, count in zip(report.teams, counts, strict=True)),
        counted="1 / 10 000",
    )
    title = f"{report.verdict.value.replace('_', ' ')}: {report.record.frames} frames"
    return draw_panels((places, lags), title, columns=2, size_px=PANEL_PX)


def _series(team: TeamFairness, counts: list[int]) -> Series:
    name = f"{team.team.value} {team.name}".strip()
    return Series(f"{name}: {team.sent} datagrams", tuple(counts), COLORS[team.team])


def _lag_counts(teams: list[TeamFairness]) -> tuple[tuple[float, ...], list[list[int]]]:
    """Edges [ms] of even bins over nearly all lags, and each team's datagrams in them as parts of all of its own."""
    bins = np.array(sorted(pair for team in teams for pair in team.lag_bins)).reshape(-1, 2)
    if not len(bins):
        return tuple(float(edge) for edge in range(LAG_BINS + 1)), [[0] * LAG_BINS for _ in teams]
    below = np.cumsum(bins[:, 1])
    last_ms = float(bins[np.searchsorted(below, MOST * below[-1]), 0])
    first_ms = 0.95 * float(bins[0, 0])
    edges = np.linspace(first_ms, max(last_ms, 1.05 * first_ms), LAG_BINS + 1)
    counts = []
    for team in teams:
        own = np.array(team.lag_bins).reshape(-1, 2)
        found = np.histogram(np.clip(own[:, 0], edges[0], edges[-1]), bins=edges, weights=own[:, 1])[0]
        counts.append(np.round(PARTS * found / max(found.sum(), 1.0)).astype(int).tolist())
    return tuple(np.round(edges, 2).tolist()), counts
