"""A match as a picture (SVG): goals, possession and collisions over its time."""

from collections.abc import Callable, Iterable
from typing import NamedTuple

from vision_core.client.play.game import Score

WIDTH, PANEL, GAP = 720, 120, 46
LEFT, RIGHT, TOP = 64, 110, 56
LABEL = 14
BLUE, YELLOW, INK, GRID = "#1d5fd6", "#b37a00", "#222222", "#d8d8d8"
WINDOW_S = 30.0
"""Collisions and possession are those of so long before."""
LEAST_S = 10.0
"""In a shorter time nothing can be said of them."""


class Line(NamedTuple):
    """One curve of a panel."""

    name: str
    color: str
    values: tuple[float, ...]


def chart(title: str, scores: Iterable[Score]) -> str:
    """The picture of a match. scores: since its beginning, in order."""
    all_scores = tuple(scores)
    recent = tuple(_recent(all_scores, score.played_s) for score in all_scores)
    panels = (
        ("goals", _lines(all_scores, lambda score: (float(score.goals[0]), float(score.goals[1])))),
        (
            f"possession [%], of the last {WINDOW_S:g} s",
            _lines(recent, lambda score: (100.0 * score.blue_share, 100.0 - 100.0 * score.blue_share)),
        ),
        (
            f"collisions a minute, of the last {WINDOW_S:g} s",
            (Line("all", INK, tuple(score.collisions_per_minute for score in recent)),),
        ),
    )
    times_s = tuple(score.played_s for score in all_scores)
    height = TOP + len(panels) * (PANEL + GAP)
    drawn = "".join(_panel(name, lines, times_s, TOP + i * (PANEL + GAP)) for i, (name, lines) in enumerate(panels))
    return (
        f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {WIDTH} {height}" width="{WIDTH}" height="{height}"'
        f' font-family="sans-serif" font-size="12" fill="{INK}"><rect width="100%" height="100%" fill="#ffffff"/>'
        f'<text x="{LEFT}" y="24" font-size="15">{_escaped(title)}</text>{drawn}</svg>\n'
    )


def _recent(scores: tuple[Score, ...], now_s: float) -> Score:
    """What happened in the WINDOW_S before a time. In the beginning, what happened until LEAST_S."""
    until_s = max(now_s, min(LEAST_S, scores[-1].played_s))
    end = next(score for score in scores if score.played_s >= until_s)
    return end.since(next(score for score in scores if score.played_s >= until_s - WINDOW_S))


def _lines(scores: tuple[Score, ...], of_teams: Callable[[Score], tuple[float, float]]) -> tuple[Line, ...]:
    pairs = [of_teams(score) for score in scores]
    return (
        Line("blue", BLUE, tuple(pair[0] for pair in pairs)),
        Line("yellow", YELLOW, tuple(pair[1] for pair in pairs)),
    )


def _panel(name: str, lines: tuple[Line, ...], times_s: tuple[float, ...], top: float) -> str:
    """One panel, with its scale on the left and its time [min] below."""
    right, bottom = WIDTH - RIGHT, top + PANEL
    last_s, highest = max(times_s[-1], 1e-9), max(1.0, *(value for line in lines for value in line.values))

    def place(time_s: float, value: float) -> str:
        return f"{LEFT + (right - LEFT) * time_s / last_s:.1f},{bottom - PANEL * value / highest:.1f}"

    parts = [f'<text x="{LEFT}" y="{top - 8:g}">{name}</text>']
    for value in (0.0, highest / 2.0, highest):
        y = bottom - PANEL * value / highest
        parts.append(f'<path d="M{LEFT} {y:g}H{right}" stroke="{GRID}"/>')
        parts.append(f'<text x="{LEFT - 8}" y="{y + 4:g}" text-anchor="end">{value:.3g}</text>')
    parts.append(f'<text x="{LEFT}" y="{bottom + 16:g}">0</text>')
    parts.append(f'<text x="{right}" y="{bottom + 16:g}" text-anchor="end">{last_s / 60.0:.1f} min</text>')
    label_y = bottom + PANEL
    for line in sorted(lines, key=lambda one: one.values[-1]):
        points = " ".join(place(time_s, value) for time_s, value in zip(times_s, line.values, strict=True))
        parts.append(f'<polyline points="{points}" fill="none" stroke="{line.color}" stroke-width="2"/>')
        label_y = min(bottom - PANEL * line.values[-1] / highest + 4, label_y - LABEL)
        label = f"{line.name} {line.values[-1]:.3g}"
        parts.append(f'<text x="{right + 8}" y="{label_y:g}" fill="{line.color}">{label}</text>')
    return "".join(parts)


def _escaped(text: str) -> str:
    return text.replace("&", "&amp;").replace("<", "&lt;")
