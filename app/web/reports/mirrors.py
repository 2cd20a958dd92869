"""The mirrors in force, and one that somebody thinks of."""

import numpy as np

from app.web.configuration.configuration import Configuration
from app.web.configuration.keys import setting
from app.web.reports.base import Report
from vision_core.models.field import diagonal_m
from vision_core.models.from_settings import FIELD, given_mirrors, mirror_from, scope_of
from vision_core.models.hyperboloid import Hyperboloid
from vision_core.models.mirror import MM_PER_M, Mirror
from vision_core.settings.schema import Settings
from vision_core.types.objects import Team

CURVE_STEP_MM = 50.0
NEAREST_MM = 100.0


class MirrorShape(Report):
    """A, B, C of equation 1 for distances in millimetres, and what they mean."""

    a: float
    b: float
    c: float
    focal_px: float
    """f of the on-board camera."""
    height_mm: float
    """h: the effective viewpoint over the floor."""
    bend: float
    """u; b/a = sinh(u/2) of the hyperboloid."""
    horizon_px: float


class MirrorInForce(MirrorShape):
    """What the robots of a scope see through."""

    scope: str
    """field, blue, yellow, or a robot: "blue 3"."""
    given_by: str
    """The scope whose mirror it is: its own, or that of the team or the field."""
    is_changed: bool
    """The page has changed that of this scope; DELETE takes the change back."""


class MirrorsReport(Report):
    """The mirrors of the field, the teams and the robots that may connect."""

    revision: int
    is_match: bool
    """In a match all robots see through one mirror, and clients cannot ask for another."""
    diagonal_m: float
    """Of the field, which a mirror must resolve."""
    mirrors: list[MirrorInForce]


class ViolationReport(Report):
    """A rule that a mirror breaks."""

    constant: str
    """a, b or c; empty: all three together."""
    found: str
    accepted: str


class CurvePoint(Report):
    """The curve at one distance."""

    r_mm: float
    r_px: float
    mm_per_px: float | None
    """Floor that one pixel spans there; null: all of it up to the horizon."""


class MirrorPreview(Report):
    """What a mirror would be. Nothing is changed."""

    scope: str
    violations: list[ViolationReport]
    """Rules that it breaks; empty: it would be accepted."""
    mirror: MirrorShape | None
    """null: it is none."""
    curve: list[CurvePoint]
    """From 100 mm to the field's diagonal; empty: it is no mirror."""


def entries_of(scope: str) -> dict[str, str]:
    """The document's entries of a scope: that of each constant, or, under "", that of all three."""
    if scope == FIELD:
        return {name: setting(f"mirror.{name}") for name in "abc"}
    return {"": setting(f"mirror.{scope}" if scope in set(Team) else f"mirror.robots.{scope}")}


def mirrors_from(configuration: Configuration) -> MirrorsReport:
    """All mirrors in force."""
    settings = configuration.settings
    robots = [(team, number) for team in Team for number in range(1, settings.match.numbers + 1)]
    return MirrorsReport(
        revision=configuration.revision,
        is_match=settings.match.mode == "match",
        diagonal_m=diagonal_m(settings.field),
        mirrors=[
            in_force(configuration, team, number)
            for team, number in [(None, None), *((team, None) for team in Team), *robots]
        ],
    )


def in_force(configuration: Configuration, team: Team | None, number: int | None = None) -> MirrorInForce:
    """The mirror of a scope: the field's robots, those of a team, or one robot."""
    settings, scope = configuration.settings, scope_of(team, number)
    given_by, constants = next(given_mirrors(settings.mirror, team, number))
    is_changed = any(key in configuration.entries for key in entries_of(scope).values())
    return MirrorInForce(scope=scope, given_by=given_by, is_changed=is_changed, **shape_of(mirror_from(constants)))


def preview_from(
    scope: str, mirror: Mirror | None, violations: list[ViolationReport], settings: Settings
) -> MirrorPreview:
    """The report of a mirror that somebody thinks of; None: it is none."""
    return MirrorPreview(
        scope=scope,
        violations=violations,
        mirror=None if mirror is None else MirrorShape(**shape_of(mirror)),
        curve=[] if mirror is None else _curve(mirror, diagonal_m(settings.field)),
    )


def shape_of(mirror: Mirror) -> dict[str, float]:
    """The fields of a ``MirrorShape``."""
    shape = Hyperboloid.of(mirror)
    return {
        "a": mirror.a,
        "b": mirror.b,
        "c": mirror.c,
        "focal_px": shape.focal_px,
        "height_mm": shape.height_mm,
        "bend": shape.bend,
        "horizon_px": mirror.horizon_px,
    }


def _curve(mirror: Mirror, farthest_m: float) -> list[CurvePoint]:
    distances = np.arange(NEAREST_MM, farthest_m * MM_PER_M + CURVE_STEP_MM, CURVE_STEP_MM)
    radii = mirror.px_from_mm(distances)
    spans = mirror.mm_from_px(radii + 0.5) - mirror.mm_from_px(radii - 0.5)
    return [
        CurvePoint(r_mm=mm, r_px=px, mm_per_px=span if np.isfinite(span) else None)
        for mm, px, span in zip(distances.tolist(), radii.tolist(), spans.tolist(), strict=True)
    ]
