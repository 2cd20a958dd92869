"""The impartiality report as one HTML file, which needs nothing else: to print, to send, to keep."""

import base64
import time
from collections.abc import Iterable, Iterator
from html import escape

from app.web.fairness.picture import draw_fairness
from app.web.reports.fairness import FairnessReport, RobotFairness, ServedReport, TeamFairness
from vision_core.native.opencv import encode_png

STYLE = (
    "body{font:16px/1.5 system-ui,sans-serif;max-width:70em;margin:2em auto;padding:0 1em;color:#111;background:#fff}"
    "img{max-width:100%}table{border-collapse:collapse}th,td{padding:.2em .8em;border-bottom:1px solid #bbb;"
    "text-align:right}th:first-child,td:first-child{text-align:left}.verdict{font-size:1.4em;font-weight:650}"
    "code{overflow-wrap:anywhere}.scroll{overflow-x:auto}"
)
VERDICTS = {"impartial": "Impartial", "not_proven": "Not proven", "biased": "Biased"}
SERVED = ("sent", "dropped", "mean place", "lag mean [ms]", "p50 [ms]", "p99 [ms]")
FOOT = (
    "Places: 0 is first, 1 is last, 0.5 is fair. A lag counts from the grab of the image until the datagram was sent."
    " p is the probability of such a chi-square in a random order, adjusted for the number of robots."
)


def html_of(report: FairnessReport) -> str:
    """The whole file."""
    return "\n".join(
        (
            '<!doctype html><html lang="en"><head><meta charset="utf-8"><title>Impartiality report</title>',
            f'<meta name="viewport" content="width=device-width"><style>{STYLE}</style></head><body>',
            *_body(report),
            "</body></html>\n",
        )
    )


def _body(report: FairnessReport) -> Iterator[str]:
    picture = base64.b64encode(encode_png(draw_fairness(report))).decode()
    yield f"<h1>Impartiality report</h1><p>{escape(_title(report))}</p>"
    yield f'<p class="verdict">{VERDICTS[report.verdict]}</p>'
    yield f"<ul>{''.join(f'<li>{escape(reason)}</li>' for reason in report.reasons)}</ul>"
    yield f'<img alt="Places in the order of sending, and lags, of both teams" src="data:image/png;base64,{picture}">'
    yield "<h2>Teams</h2>" + _table(("team", *SERVED), map(_team_cells, report.teams))
    places = report.places
    yield f"<p>Chi-square of the teams' places: {places.chi_square:.1f}, {places.freedom} degrees of freedom,"
    yield f"p = {places.p:.3g}.</p>"
    yield "<h2>Robots</h2>" + _table(("robot", *SERVED, "chi-square", "freedom", "p"), map(_robot_cells, report.robots))
    yield f"<p>{FOOT}</p>"
    if report.record.seed is not None:
        yield f"<p>Seed of the order of sending: <code>{report.record.seed}</code></p>"
    yield f"<p>SHA-256 of the seed: <code>{report.record.seed_sha256}</code></p>"


def _title(report: FairnessReport) -> str:
    record = report.record
    names = " against ".join(f"{team.name} ({team.team})" if team.name else team.team for team in report.teams)
    until = _time(record.ended_s) if record.ended_s else "now"
    return f"{names}, {_time(record.began_s)} to {until}, {record.frames} frames"


def _table(head: Iterable[str], rows: Iterable[Iterable[str]]) -> str:
    titles = "".join(f"<th>{title}</th>" for title in head)
    lines = "".join(f"<tr>{''.join(f'<td>{escape(cell)}</td>' for cell in cells)}</tr>" for cells in rows)
    return f'<div class="scroll"><table><tr>{titles}</tr>{lines}</table></div>'


def _team_cells(team: TeamFairness) -> tuple[str, ...]:
    return f"{team.team} {team.name}", *_served_cells(team)


def _robot_cells(robot: RobotFairness) -> tuple[str, ...]:
    test = f"{robot.chi_square:.1f}", str(robot.freedom), f"{robot.p:.3g}"
    return f"{robot.team} {robot.number}", *_served_cells(robot), *test


def _served_cells(served: ServedReport) -> tuple[str, ...]:
    lags_ms = served.lag_mean_ms, served.lag_p50_ms, served.lag_p99_ms
    lags = ("" if lag_ms is None else f"{lag_ms:.3f}" for lag_ms in lags_ms)
    return str(served.sent), str(served.dropped), f"{served.mean_place:.4f}", *lags


def _time(seconds: float) -> str:
    return time.strftime("%Y-%m-%d %H:%M:%S", time.localtime(seconds))
