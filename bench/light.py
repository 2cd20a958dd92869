"""How fast ids are right again when the light changes while the service runs.

Setup: the running service with its simulated camera over a Very Small Size field with ten robots, and ten connected
clients. Every change of ``evaluation.lights`` is made in the camera's light by the live settings ``faults.light``,
lasts some seconds and is taken back for as long. Nobody touches the service. The baseline is the simulated match itself
(``true_world``): an id is right when the robot that the clients are told of under it is where it truly is, and wrong
when another robot is there.

For each change: how long until all ids are right and stay so for half a second; the share of right ids from 2 s after
the change on; wrong ids in all its frames; ``see`` messages per client and second. The rows "back" are those of the way
back to the first light, together. ``bench/out/light.png`` shows the share of right ids over time.
"""

import argparse
import contextlib
import json
import time
from dataclasses import dataclass, field
from pathlib import Path

import msgspec
import numpy as np

from app.web.charts.panels import BLUE, ORANGE, Panel, Series, draw_panels
from bench.helpers import Helper, with_progress
from bench.runner import OUT, Row
from bench.service import RunningService, attached_service
from bench.true_world import TrueWorld
from vision_core.capture.faults import NO_LIGHT_FAULT
from vision_core.clock import Instant, MonotonicClock, after, seconds_between
from vision_core.evaluation.lights import LIGHT_FAULTS
from vision_core.native.opencv import write_picture
from vision_core.net.control import Attached
from vision_core.rtdb import records
from vision_core.settings.schema import LightFaultSettings, Settings
from vision_core.types.tracks import World
from vision_core.venues.loader import load_settings

VENUE = "demo-vsss"
PER_TEAM = 5
OPTIONS = f"synthetic.robots_per_team = {PER_TEAM}\nmatch.numbers = {PER_TEAM}\ntasks.source.priority = 5\n"
"""The simulated camera has the lowest real-time priority: a real one takes no time from other programs, nor they from
it. The task ``follow`` has none."""
LASTS_S = 4.0
SETTLE_S = 10.0
"""After the start, before the first change."""
GOAL_S, GOAL_SHARE = 2.0, 0.99
STAYS_S = 0.5
"""All ids are right again when they stay so for so long."""
CALM_S = 0.7
"""The frames of so long before a change tell how far the match has come."""
MAX_DRIFT_S = 120.0
"""The match may have begun so much earlier than the measurement, beside the service's uptime."""
POLL_S = 0.004
BIN_S = 0.1
PANEL_PX, COLUMNS = (330, 230), 6


@dataclass(slots=True)
class Stretch:
    """The frames after one change of the light."""

    light: str
    is_back: bool
    start: Instant
    end: Instant
    worlds: list[World] = field(default_factory=list)
    messages_per_s: float = 0.0
    """Of each client."""
    scores: list[tuple[float, int, int]] = field(default_factory=list)
    """Of every frame: time since the change [s], right ids, wrong ids."""

    def again_s(self, robots: int) -> float:
        """When all ids are right and stay so [s]; nan: never."""
        times = np.array([time for time, _, _ in self.scores])
        is_right = np.array([right == robots for _, right, _ in self.scores])
        for index, time_s in enumerate(times):
            window = (times >= time_s) & (times <= time_s + STAYS_S)
            if is_right[index] and is_right[window].mean() >= GOAL_SHARE and time_s + STAYS_S <= times[-1]:
                return float(time_s)
        return float("nan")

    def share(self, robots: int) -> float:
        """Of right ids from GOAL_S on."""
        late = [right for time_s, right, _ in self.scores if time_s >= GOAL_S]
        return sum(late) / (len(late) * robots) if late else float("nan")

    @property
    def wrong(self) -> int:
        """Wrong ids in all frames."""
        return sum(wrong for _, _, wrong in self.scores)


def run(seconds: float = LASTS_S, out: Path = OUT) -> list[Row]:
    """Every change. seconds: how long each lasts, and the first light between two."""
    stretches, robots = measure(seconds)
    out.mkdir(exist_ok=True)
    write_picture(out / "light.png", drawn(stretches, robots, seconds))
    rows = []
    for light in dict.fromkeys(stretch.light for stretch in stretches):
        (there,) = (one for one in stretches if one.light == light and not one.is_back)
        rows += _rows(light, [there], robots)
    return [*rows, *_rows("back", [one for one in stretches if one.is_back], robots)]


def measure(seconds: float) -> tuple[list[Stretch], int]:
    """All stretches with their scores, and how many robots there are."""
    settings = load_settings(VENUE, options={"synthetic.robots_per_team": PER_TEAM, "match.numbers": PER_TEAM})
    stretches: list[Stretch] = []
    with contextlib.ExitStack() as stack:
        service, attached = stack.enter_context(attached_service(OPTIONS, "--venue", VENUE))
        receiver = stack.enter_context(Helper("bench.receiver", service.udp_port, PER_TEAM))
        worlds = _watched(attached, SETTLE_S)
        for light in with_progress([name for name in LIGHT_FAULTS if name != "as it is"], "light"):
            for is_back in (False, True):
                begun = MonotonicClock().now()
                _shine(service, NO_LIGHT_FAULT if is_back else LIGHT_FAULTS[light])
                stretch = Stretch(light, is_back, begun, after(begun, seconds))
                stretch.worlds = _watched(attached, seconds)
                stretches.append(stretch)
        views = receiver.finish()
    for stretch in stretches:
        counted = [count for _, count, first, _ in views["views"] if stretch.start <= first < stretch.end]
        stretch.messages_per_s = sum(counted) / seconds / views["clients"]
    return stretches, _score(settings, worlds, stretches)


def _shine(service: RunningService, fault: LightFaultSettings) -> None:
    changes = {f"faults.light.{key}": value for key, value in msgspec.to_builtins(fault).items()}
    code, answer = service.request("PATCH", "/api/v1/settings", {"changes": changes})
    if code != 200:
        raise RuntimeError(f"faults.light: the service answered {code} {answer}; 200 was expected")


def _watched(attached: Attached, seconds: float) -> list[World]:
    """All worlds of some time [s]."""
    reader, clock = records.WORLD.reader(attached.store), MonotonicClock()
    seen, last, end = [], reader.sequence, after(clock.now(), seconds)
    while clock.now() < end:
        if reader.sequence != last:
            last = reader.sequence
            if (timed := reader.read(clock.now())) is not None:
                seen.append(timed.value)
        time.sleep(POLL_S)
    return seen


def _score(settings: Settings, calm: list[World], stretches: list[Stretch]) -> int:
    """Score every frame; the match is found anew before each change, since a pause of the machine delays it."""
    true = TrueWorld(settings)
    played_s = MAX_DRIFT_S + seconds_between(stretches[0].start, stretches[-1].end)
    for stretch in stretches:
        before = [world for world in calm if seconds_between(world.at, stretch.start) <= CALM_S]
        if not stretch.is_back and not (before and true.align(before, played_s)):
            raise RuntimeError(f"{stretch.light}: the simulated match was not found in the frames before it")
        for world in stretch.worlds:
            if (since_s := seconds_between(stretch.start, world.at)) >= 0.0:
                stretch.scores.append((since_s, *true.score(world)))
        calm = stretch.worlds
    return len(true.robots)


def _rows(name: str, stretches: list[Stretch], robots: int) -> list[Row]:
    again = max((one.again_s(robots) for one in stretches), key=lambda time_s: np.inf if np.isnan(time_s) else time_s)
    share, wrong = min(one.share(robots) for one in stretches), sum(one.wrong for one in stretches)
    messages = min(one.messages_per_s for one in stretches)
    worst = " (worst)" if len(stretches) > 1 else ""
    return [
        {
            "name": f"{name}: all ids right again after{worst}",
            "value": None if np.isnan(again) else round(again, 2),
            "unit": "s",
            "goal": f"<= {GOAL_S:g}",
            "met": bool(again <= GOAL_S),
        },
        {
            "name": f"{name}: ids right from {GOAL_S:g} s on{worst}",
            "value": round(share, 4),
            "goal": f">= {GOAL_SHARE}",
            "met": share >= GOAL_SHARE,
        },
        {"name": f"{name}: wrong ids", "value": wrong, "goal": "0", "met": wrong == 0},
        {"name": f"{name}: see messages per client{worst}", "value": round(messages, 1), "unit": "1/s"},
    ]


def drawn(stretches: list[Stretch], robots: int, seconds: float) -> np.ndarray:
    """The share of right ids over time after every change, and after it was taken back; a panel each."""
    edges = tuple(np.arange(0.0, seconds + BIN_S / 2.0, BIN_S).tolist())
    panels = []
    for light in dict.fromkeys(stretch.light for stretch in stretches):
        series = []
        for stretch in stretches:
            if stretch.light == light:
                name, color = ("back", ORANGE) if stretch.is_back else (light, BLUE)
                series.append(Series(name, _shares(stretch, robots, edges), color))
        panels.append(Panel(light, "time after the change [s]", edges, tuple(series), counted="ids right [%]"))
    title = f"{VENUE}: {robots} robots, ten clients; each light lasts {seconds:g} s"
    return draw_panels(panels, title, COLUMNS, PANEL_PX)


def _shares(stretch: Stretch, robots: int, edges: tuple[float, ...]) -> tuple[int, ...]:
    """The share of right ids in every bin of time [%]."""
    times = np.array([time_s for time_s, _, _ in stretch.scores])
    rights = np.array([right for _, right, _ in stretch.scores], dtype=np.float64)
    number = np.digitize(times, edges) - 1
    return tuple(
        round(100.0 * float(rights[number == index].mean()) / robots) if (number == index).any() else 0
        for index in range(len(edges) - 1)
    )


def main() -> None:
    """Command line: the picture elsewhere, or other durations."""
    parser = argparse.ArgumentParser(prog="python -m bench.light", description=__doc__.partition("\n")[0])
    parser.add_argument("--seconds", type=float, default=LASTS_S, help="how long each light lasts")
    parser.add_argument("--out", type=Path, default=OUT, help="folder of the picture")
    arguments = parser.parse_args()
    for row in run(arguments.seconds, arguments.out):
        print(json.dumps(row))


if __name__ == "__main__":
    main()
