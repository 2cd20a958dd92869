"""Rules that span several settings: what the type and range of a single key cannot say."""

import ipaddress
import re
from collections.abc import Callable, Iterator, Mapping

from vision_core.errors import SettingsError
from vision_core.models.field import diagonal_m
from vision_core.models.from_settings import mirror_from, scope_of
from vision_core.models.mirror import check_span
from vision_core.settings.schema import ColorRange, MirrorConstants, Settings
from vision_core.types.edges import letter_faults
from vision_core.types.objects import Team
from vision_core.types.tables import MAX_NUMBERS
from vision_core.venues.camera_rules import camera_violations
from vision_core.venues.mask_rules import mask_violations
from vision_core.venues.violation import Violation

SPACE_KEYS = {
    "hsv": {"hue_deg", "saturation", "value"},
    "ymp": {"luma", "module", "phase_deg"},
    "ec": {"luma", "hue_deg", "saturation"},
}
"""Axes of each color space."""
ANGLES = {"hue_deg", "phase_deg"}
MAX_CLASSES = 31
MAX_DIRECTIONS = 448
"""Of a view: more do not fit into a datagram."""
RAYS_PER_DEG = 4
TASK_NAME = re.compile(r"[a-z][a-z0-9_]{0,15}")
ROBOTS = tuple(scope_of(team, number) for team in Team for number in range(1, MAX_NUMBERS + 1))
ONE_MIRROR = "in a match the same mirror for all robots of both teams"
SAMPLE_COMMAND = "pslv colors sample PICTURE --venue FILE --save --class {name} --at X,Y"


def check_settings(settings: Settings, place_of: Callable[[str], str], *, complete_palette: bool = True) -> None:
    """Raise SettingsError for the first rule that does not hold.

    place_of: names the file and line that set a key; complete_palette: the colors of the ball must have classes; False
    for commands that help to make a palette.
    """
    rules = [_colors, _letters, _match, mask_violations, camera_violations, _match_views, _mirror, _tasks, _admission]
    if complete_palette:
        rules.append(_ball_colors)
    for rule in rules:
        for violation in rule(settings):
            where = f"{place_of(violation.key)}: {violation.key}"
            raise SettingsError(where, found=violation.found, accepted=violation.accepted)


def class_names(settings: Settings) -> list[str]:
    """Every color class, by ranges or by samples."""
    return [*settings.colors.classes, *(name for name in settings.colors.samples if name != "none")]


def _colors(settings: Settings) -> Iterator[Violation]:
    samples = settings.colors.samples
    classes = class_names(settings)
    if both := sorted(settings.colors.classes.keys() & samples.keys()):
        accepted = "each class either in colors.classes or in colors.samples"
        yield Violation("colors.samples", f"{', '.join(both)} in both", accepted)
    if len(classes) > MAX_CLASSES:
        yield Violation("colors.classes", f"{len(classes)} classes", f"at most {MAX_CLASSES}")
    for name, boxes in settings.colors.classes.items():
        for box in boxes:
            yield from _box(f"colors.classes.{name}", box, settings.colors.space)
    owners: dict[str, str] = {}
    for name, texts in samples.items():
        for text in texts:
            if (owner := owners.setdefault(text.lower(), name)) != name:
                yield Violation(f"colors.samples.{name}", f"{text}, a sample of {owner} too", "each color in one class")
    low, high = settings.colors.light.band
    if low >= high:
        yield Violation("colors.light.band", f"[{low:g}, {high:g}]", "two shares, the lower one first")


def _ball_colors(settings: Settings) -> Iterator[Violation]:
    classes = class_names(settings)
    wanted = [("ball.color", settings.ball.color), *(("ball.surrounding", name) for name in settings.ball.surrounding)]
    for key, name in wanted:
        if name not in classes:
            known = ", ".join(classes) or "there is none yet"
            measure = SAMPLE_COMMAND.format(name=repr(name) if " " in name else name)
            yield Violation(key, repr(name), f"a color class: {known}; to make it: {measure}")


def _box(key: str, box: ColorRange, space: str) -> Iterator[Violation]:
    given = {axis: getattr(box, axis) for axis in box.__struct_fields__ if getattr(box, axis) is not None}
    if foreign := sorted(given.keys() - SPACE_KEYS[space]):
        yield Violation(key, ", ".join(foreign), f"{', '.join(sorted(SPACE_KEYS[space]))} (colors.space is {space})")
    for axis, (low, high) in given.items():
        if axis not in ANGLES and low > high:
            yield Violation(f"{key}.{axis}", f"[{low:g}, {high:g}]", "the lower end first")


def _letters(settings: Settings) -> Iterator[Violation]:
    for key, found, accepted in letter_faults(settings.protocol.letters):
        yield Violation(f"protocol.letters.{key}", found, accepted)


def _match(settings: Settings) -> Iterator[Violation]:
    numbers = settings.match.numbers
    for key in ("blue_ids", "yellow_ids"):
        ids = getattr(settings.match, key)
        if len(ids) < numbers or len(set(ids)) < len(ids):
            accepted = f"at least match.numbers ({numbers}) ids, each once"
            yield Violation(f"match.{key}", f"{len(ids)} ids, {list(ids)}", accepted)


def _match_views(settings: Settings) -> Iterator[Violation]:
    """The views of a match must be ones that every client could ask for."""
    views = settings.match.views
    first_deg = views.center_deg - views.fov_deg / 2.0
    if not all((RAYS_PER_DEG * angle).is_integer() for angle in (first_deg, views.resolution_deg)):
        found = f"directions from {first_deg:g} deg, every {views.resolution_deg:g} deg"
        yield Violation("match.views.resolution_deg", found, f"multiples of {1 / RAYS_PER_DEG:g} deg")
    directions = int(views.fov_deg / views.resolution_deg)
    if not 1 <= directions <= MAX_DIRECTIONS:
        yield Violation("match.views.fov_deg", f"{directions} directions", f"1..{MAX_DIRECTIONS} directions")


def _mirror(settings: Settings) -> Iterator[Violation]:
    mirrors = settings.mirror
    teams = {f"mirror.{team}": own for team, own in (("blue", mirrors.blue), ("yellow", mirrors.yellow)) if own}
    robots = {f"mirror.robots.{robot}": own for robot, own in mirrors.robots.items()}
    for robot in mirrors.robots:
        if robot not in ROBOTS:
            yield Violation(
                f"mirror.robots.{robot}", repr(robot), f'a team and a number, "{ROBOTS[0]}" to "{ROBOTS[-1]}"'
            )
    for key, constants in {"mirror": mirrors, **teams, **robots}.items():
        try:
            check_span(mirror_from(constants), diagonal_m(settings.field))
        except SettingsError as error:
            yield Violation(key, error.found, error.accepted)
    if settings.match.fixes_views:
        yield from _one_mirror(mirrors, teams, robots)


def _one_mirror(
    field: MirrorConstants, teams: Mapping[str, MirrorConstants], robots: Mapping[str, MirrorConstants]
) -> Iterator[Violation]:
    """In a match all robots of both teams see through the same mirror."""
    common = mirror_from(field)
    if len(teams) == len(Team):
        common = mirror_from(next(iter(teams.values())))
    for key, constants in {**teams, **robots}.items():
        if (own := mirror_from(constants)) != common:
            found = f"A {own.a:g}, B {own.b:g}, C {own.c:g}, in match mode"
            yield Violation(
                key, found, f"{ONE_MIRROR}, A {common.a:g}, B {common.b:g}, C {common.c:g}; or practice mode"
            )


def _tasks(settings: Settings) -> Iterator[Violation]:
    for name, task in settings.tasks.items():
        if not TASK_NAME.fullmatch(name):
            yield Violation(f"tasks.{name}", repr(name), "small letters, digits and _ , 16 at most, a letter first")
        if task.process and not TASK_NAME.fullmatch(task.process):
            yield Violation(f"tasks.{name}.process", repr(task.process), "a name as of a task, or nothing")


def _admission(settings: Settings) -> Iterator[Violation]:
    admission = settings.admission
    named = {"subnets": admission.subnets, "rules": [r.network for r in admission.rules], "refused": admission.refused}
    for key, networks in named.items():
        for network in networks:
            try:
                ipaddress.ip_network(network)
            except ValueError as error:
                yield Violation(f"admission.{key}", str(error), "an address or a subnet, 192.168.1.0/24")
