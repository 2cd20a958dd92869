"""What would explain the robots of a picture better: another pattern, another size of markers, a mirrored picture."""

import contextlib
from collections.abc import Callable, Iterator
from functools import partial

import msgspec
import numpy as np

from vision_core.errors import SettingsError
from vision_core.objects.robots.buffers import finder_buffers
from vision_core.objects.robots.finder import RobotFinder, robot_finder
from vision_core.objects.robots.scene import Scene, counted, patterns_of
from vision_core.patterns.loader import load_pattern
from vision_core.patterns.pattern import mirrored, scaled
from vision_core.settings.schema import Settings, TeamRobotSettings
from vision_core.types.reasons import Reason
from vision_core.types.tables import NO_ID, TEAMS, Table
from vision_core.venues.loader import config_folder

SCALES = tuple(round(1.06**step, 2) for step in range(-12, 13) if step)
"""Factors of the marker's size that are tried when robots are not identified: half to double."""
MIN_GAIN_RATIO = 1.3
"""Another pattern is suggested when it explains the picture better by this factor."""
NO_ID_WEIGHT = 0.2
"""Of the confidence of a robot without an id, when patterns are compared."""
MIN_MIRRORED, MIN_STRANGE = 2, 3
"""So many robots must agree that the picture is a mirror image: those that exist only mirrored, and those whose ids no
robot of the match has, which may just be other robots."""
SAME_PX = 3.0
"""Robots nearer to each other are one."""


def mirror_reason(scene: Scene, robots: Table, settings: Settings) -> Reason | None:
    """That the picture is a mirror image: markers that exist only mirrored, or ids that only mirrored ones have.

    robots: those that are found, ROBOT. A pattern that has a mirrored marker of another id for each marker shows it by
    the ids that the match gives to its robots.
    """
    found = scene.robots(robot_finder(settings, scene.table, mirrored))
    read, read_mirrored = (table[table["id"] != NO_ID] for table in (robots, found))
    text = "this picture is a mirror image"
    advice = "Switch off mirroring (flip) in the camera's driver, or in the program that saves its pictures."
    if len(read_mirrored) >= len(read) + MIN_MIRRORED and _gain(found) > MIN_GAIN_RATIO * _gain(robots):
        seen = (
            f"{counted(len(read_mirrored), 'marker')} exist only mirrored in the robots' pattern, {len(read)} as seen"
        )
        return Reason(f"{text}: {seen}", advice, float(len(read_mirrored)), is_calibration=True)
    strange, expected, shown = 0, 0, []
    for robot in read:
        away = np.hypot(read_mirrored["x_px"] - robot["x_px"], read_mirrored["y_px"] - robot["y_px"])
        if not len(away) or away.min() > SAME_PX:
            return None
        other = read_mirrored[int(away.argmin())]
        ids = _ids_of(settings, int(robot["team"]))
        if int(robot["id"]) not in ids:
            strange += 1
            shown.append(f"{TEAMS[robot['team']]} {robot['id']} would be {other['id']}")
        expected += other["team"] == robot["team"] and int(other["id"]) in ids
    if strange < MIN_STRANGE or expected < len(read):
        return None
    seen = f"{strange} of the {len(read)} robots have ids that no robot of the match has, and mirrored all have one"
    return Reason(f"{text}: {seen} ({', '.join(shown)})", advice, float(len(read)), is_calibration=True)


def _ids_of(settings: Settings, team: int) -> tuple[int, ...]:
    """The marker ids of the robots that may connect for a team."""
    return settings.match.ids_of(TEAMS[team])[: settings.match.numbers]


def better_pattern(scene: Scene, robots: Table, settings: Settings, is_over: Callable[[], bool]) -> list[Reason]:
    """The shipped pattern, or the size of the own one, that explains the picture best, if it is clearly better."""
    best, best_gain = None, MIN_GAIN_RATIO * _gain(robots)
    own = int((robots["id"] != NO_ID).sum())
    for reason, finder in (*_finders_of_other_patterns(scene, settings), *_finders_of_other_sizes(scene, settings)):
        if is_over():
            break
        found = scene.robots(finder)
        ids = int((found["id"] != NO_ID).sum())
        if ids and (gain := _gain(found)) > best_gain:
            text = f"{reason.text} {counted(ids, 'robot')} would be identified"
            best = Reason(text, reason.advice, float(ids - own), reason.is_calibration)
            best_gain = gain
    return [best] if best else []


def _finders_of_other_patterns(scene: Scene, settings: Settings) -> Iterator[tuple[Reason, RobotFinder]]:
    """For every shipped pattern whose colors are classes of this venue: a finder, and its reason's first words.

    None where a team wears several patterns.
    """
    own = patterns_of(settings)
    if len(own) > len(TEAMS):
        return
    for path in sorted((config_folder() / "patterns").glob("*.toml")):
        if path.stem in own:
            continue
        shape = load_pattern(path.stem).robot
        team = TeamRobotSettings(
            pattern=path.stem, outline=shape.outline, radius_m=shape.radius_m, height_m=shape.height_m
        )
        other = msgspec.structs.replace(settings.robots, blue=team, yellow=team)
        with contextlib.suppress(SettingsError):
            finder = robot_finder(msgspec.structs.replace(settings, robots=other), scene.table)
            text = f"another pattern? With robots.pattern = {path.stem!r}"
            yield Reason(text, f"Set robots.pattern = {path.stem!r} if the robots wear it."), finder


def _finders_of_other_sizes(scene: Scene, settings: Settings) -> Iterator[tuple[Reason, RobotFinder]]:
    """A finder for markers that look larger or smaller than they are, as a wrong camera height makes them."""
    buffers = finder_buffers(settings.blobs.max_blobs, len(patterns_of(settings)))
    for factor in SCALES:
        area = f"blobs have {factor**2:.1f} times the expected area"
        text = f"wrong camera height or field size? The {area}; with markers {factor:.2f} times as large"
        finder = robot_finder(settings, scene.table, partial(scaled, factor=factor), buffers)
        yield Reason(text, "Measure the camera's height and the field again.", is_calibration=True), finder


def _gain(robots: Table) -> float:
    """How well robots explain the picture: the sum of their confidences, less weight for those without an id."""
    return float((robots["confidence"] * np.where(robots["id"] != NO_ID, 1.0, NO_ID_WEIGHT)).sum())
