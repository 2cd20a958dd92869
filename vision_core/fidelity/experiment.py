"""The experiment: random worlds, seen from the ceiling and from the robot, compared and counted."""

from collections.abc import Callable, Iterable
from dataclasses import dataclass, field

import numpy as np

from vision_core.capture.synthetic.world import Snapshot
from vision_core.fidelity.agreement import Agreement, compare
from vision_core.fidelity.balls import HALF, BallComparison, compare_balls
from vision_core.fidelity.causes import FINER, Cause, Evidence, explain
from vision_core.fidelity.ceiling import CeilingSide, Detection
from vision_core.fidelity.onboard import OnboardSide
from vision_core.fidelity.reports import Report
from vision_core.fidelity.worlds import CEILING_PX, Setup, random_world
from vision_core.geometry import Floats, Mask
from vision_core.onboard.scene import Scene
from vision_core.onboard.truth import seen_ball
from vision_core.views.renderer import GRIDS

Show = Callable[[str], None]
"""Is called with how far the work is."""
RANGES_MM = (110.0, 220.0, 400.0, 800.0, 1600.0, 3200.0, 12800.0)
"""Limits of the ranges in which errors are told."""


@dataclass(frozen=True, slots=True)
class Comparison:
    """One world, from one ceiling camera and one on-board camera."""

    seed: int
    told: Report
    seen: Report
    agreement: Agreement
    causes: list[Cause | None]
    exact_mm: Floats
    """Where the nearest edge is, exactly, in each direction [mm]."""
    ceiling_mm: Floats
    """Error of what is told against exact poses, where the type is right; nan elsewhere [mm]."""
    onboard_mm: Floats
    """Error of what the on-board module saw against the exact picture, in the same way [mm]."""
    detection: Detection
    ball: BallComparison


@dataclass
class Tally:
    """Comparisons of one setup."""

    setup: Setup
    worlds: int = 0
    unserved: list[int] = field(default_factory=list)
    """Seeds of worlds in which the ceiling camera did not find the viewer: it is told nothing."""
    comparisons: list[Comparison] = field(default_factory=list)

    def extend(self, other: "Tally") -> None:
        """Count the worlds of another tally of the same setup as well."""
        self.worlds += other.worlds
        self.unserved += other.unserved
        self.comparisons += other.comparisons

    @property
    def directions(self) -> int:
        """How many directions were compared."""
        return sum(len(each.causes) for each in self.comparisons)

    def share_of_type(self) -> float:
        """The share of directions in which the types agree."""
        return float(np.mean([each.agreement.same_type.mean() for each in self.comparisons]))

    def share_within(self, most_px: float) -> float:
        """The share of the directions of equal type whose distances differ by at most so many pixels."""
        return float((np.abs(self._errors_px()) <= most_px).mean())

    def error_px(self, percent: float) -> float:
        """Percentile of the absolute error of distance [px]."""
        return float(np.percentile(np.abs(self._errors_px()), percent))

    def share_of(self, cause: Cause) -> float:
        """The share of directions that disagree for a cause."""
        return sum(each.causes.count(cause) for each in self.comparisons) / max(self.directions, 1)

    def rms_mm(self, side: str, low_mm: float, high_mm: float) -> float:
        """RMS error of a side, ceiling_mm or onboard_mm, against the truth in a range; nan without any.

        The 2 % largest errors are left out: they are edges of objects, not resolution.
        """
        errors = np.concatenate(
            [getattr(each, side)[_between(each.exact_mm, low_mm, high_mm)] for each in self.comparisons]
        )
        errors = np.sort(np.abs(errors[np.isfinite(errors)]))
        errors = errors[: max(int(0.98 * len(errors)), 1)]
        return float(np.sqrt(np.square(errors).mean())) if len(errors) else float("nan")

    def hidden_agreement(self, *, clear: bool = False, ideal: bool = False) -> tuple[int, int]:
        """Worlds in which both sides agree whether the ball is hidden, and all of them.

        clear: only balls that are hidden, or show as much as the on-board picture can resolve; ideal: the on-board side
        is an ideal camera of that resolution instead of the on-board module.
        """
        balls = [each.ball for each in self.comparisons if each.ball.is_clear or not clear]
        return sum(ball.same_as_ideal if ideal else ball.same_hidden for ball in balls), len(balls)

    def balls_seen(self, low_mm: float, high_mm: float) -> tuple[int, int, int]:
        """Balls in a range of which the on-board picture shows at least half: how many there are, of how many the
        on-board side sees and of how many the ceiling camera's tells."""
        balls = [each.ball for each in self.comparisons if each.ball.onboard_share >= HALF]
        balls = [ball for ball in balls if low_mm <= ball.distance_mm < high_mm]
        return len(balls), sum(ball.seen for ball in balls), sum(ball.told for ball in balls)

    def worst(self) -> Comparison:
        """The comparison with most unexplained directions, of equal ones with most disagreements."""
        return max(
            self.comparisons,
            key=lambda each: (each.causes.count(Cause.UNEXPLAINED), int((~each.agreement.agrees).sum())),
        )

    def _errors_px(self) -> Floats:
        return np.concatenate([each.agreement.error_px[each.agreement.same_type] for each in self.comparisons])


def run(
    field_name: str,
    onboard_px: tuple[int, int],
    *,
    tall: bool,
    seeds: Iterable[int],
    show: Show,
    ceilings: Iterable[str] = tuple(CEILING_PX),
) -> dict[str, Tally]:
    """Compare worlds of a field under some ceiling cameras. Returns a tally for each; all see the same worlds."""
    setups = {ceiling: Setup(field_name, ceiling, onboard_px, tall) for ceiling in ceilings}
    tallies = {ceiling: Tally(setup) for ceiling, setup in setups.items()}
    first = next(iter(setups.values()))
    onboard = OnboardSide(first, first.mirror)
    sides = {ceiling: CeilingSide(setup) for ceiling, setup in setups.items()}
    for seed in seeds:
        show(f"{field_name} field, {'high' if tall else 'low'} robots: world {seed}")
        snapshot = random_world(onboard.settings, seed)
        scene = onboard.scene(snapshot)
        seen = onboard.report(onboard.picture(scene))
        truth = evidence(snapshot, scene, next(iter(sides.values())), onboard)
        for ceiling, side in sides.items():
            add(tallies[ceiling], seed, snapshot, seen, truth, side)
    return tallies


def add(tally: Tally, seed: int, snapshot: Snapshot, seen: Report, truth: Evidence, side: CeilingSide) -> None:
    """Compare what an on-board side saw of a world with what a ceiling side tells of it."""
    tally.worlds += 1
    world = side.world(snapshot)
    told = side.report(world, truth.mirror)
    if told is None:
        tally.unserved.append(seed)
        return
    detection = side.detection(world, snapshot)
    exact_view = truth.exact_view
    tally.comparisons.append(
        Comparison(
            seed=seed,
            told=told,
            seen=seen,
            agreement=compare(told, seen),
            causes=explain(told, seen, truth),
            exact_mm=truth.solids.foot_mm[::FINER],
            ceiling_mm=_errors_mm(told, exact_view, truth),
            onboard_mm=_errors_mm(seen, truth.exact, truth),
            detection=detection,
            ball=compare_balls(told.ball, seen.ball, exact_view.ball, truth.ball, detection, truth.mirror, truth.scale),
        )
    )


def evidence(snapshot: Snapshot, scene: Scene, ceiling: CeilingSide, onboard: OnboardSide) -> Evidence:
    """The truth of a world, for explaining: the same for every ceiling camera over the field."""
    exact_view = ceiling.report(ceiling.true_world(snapshot), onboard.mirror)
    assert exact_view is not None
    solids = onboard.first_solids(scene, FINER * GRIDS[0])
    return Evidence(
        exact_view=exact_view,
        exact=onboard.true_report(scene, solids),
        solids=solids,
        ball=seen_ball(scene),
        scene=scene,
        mirror=onboard.mirror,
        scale=onboard.geometry.scale,
        nearest_px=onboard.geometry.nearest_px,
        line_mm=onboard.line_mm,
    )


def _errors_mm(report: Report, exact: Report, truth: Evidence) -> Floats:
    """Error of the distances on the floor, before they are cut to whole pixels, where both are of one type."""
    other = exact.radii_px[:: len(exact.radii_px) // len(report.radii_px)]
    letters = exact.letters[:: len(exact.letters) // len(report.letters)]
    same = (report.letters == letters) & np.isfinite(other) & (other > truth.nearest_px + 1.0)
    radii, places = (np.where(same, px, 0.0) for px in (report.radii_px, other))
    errors = truth.mirror.mm_from_px(radii) - truth.mirror.mm_from_px(places)
    return np.where(same & np.isfinite(errors), errors, np.nan)


def _between(mm: Floats, low_mm: float, high_mm: float) -> Mask:
    return np.asarray((mm >= low_mm) & (mm < high_mm))
