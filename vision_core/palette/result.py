"""What was found: the colors as settings, how sure they are, and what people should do about it."""

from collections.abc import Sequence
from dataclasses import dataclass

import msgspec
import numpy as np

from vision_core.color.samples import NONE, Measured, hex_from_bgr, references_from
from vision_core.objects.robots.scene import counted
from vision_core.palette.learn import LEARNED
from vision_core.palette.reading import Palette
from vision_core.palette.trial import BALL, Trial
from vision_core.settings.schema import ColorSettings
from vision_core.types.reasons import Reason
from vision_core.types.tables import TEAMS

TOO_NEAR, NEAR = 2.5, 4.0
"""Papers whose colors lie less than this many spreads apart are not told apart for sure; nearly so."""
LEAST_SPREAD = 0.1
"""One picture shows less of a paint's spread than a match does."""
CLEAR_EVIDENCE = 0.5
MAX_PLACES = 6
"""So many places are listed."""


@dataclass(frozen=True, slots=True)
class PaintFound:
    """The color of one paint."""

    name: str
    color: str
    """Its mean, "#rrggbb"."""
    patches: int
    """How many patches show it; 0: no robot that was read wears it, and its name alone tells it."""


@dataclass(frozen=True, slots=True)
class NearPaints:
    """Two papers that look alike."""

    one: str
    other: str
    spreads: float
    """How far apart they are."""


@dataclass(frozen=True, slots=True)
class PictureRead:
    """What is read in one picture with the colors."""

    robots: int
    with_id: int
    clear: int
    """Robots whose markers the picture shows clearly."""
    balls: int
    unread: tuple[tuple[int, int], ...]
    """Where something has a robot's color and is not read [px]."""


@dataclass(frozen=True, slots=True)
class ColorsFound:
    """Colors of a venue. ``colors`` replaces its [colors], classes, samples and light."""

    colors: ColorSettings
    paints: tuple[PaintFound, ...]
    near: tuple[NearPaints, ...]
    pictures: tuple[PictureRead, ...]
    refused: tuple[Reason, ...]
    """Why the colors are of no use, and what to do; none when they are."""
    remarks: tuple[Reason, ...]
    """What to know about colors that can be used."""

    @property
    def accepted(self) -> bool:
        """Was every robot's paint learned that the pictures show, and are all papers told apart?"""
        return not self.refused

    @property
    def reasons(self) -> tuple[Reason, ...]:
        """All of both."""
        return *self.refused, *self.remarks


def result_of(trial: Trial, palette: Palette) -> ColorsFound:
    """A palette in the form that people and files use."""
    measured = palette.measured
    assert measured is not None
    samples = {name: tuple(hex_from_bgr(bgr) for bgr in colors.tolist()) for name, colors in measured.classes.items()}
    samples[NONE] = tuple(hex_from_bgr(bgr) for bgr in measured.none.tolist())
    colors = msgspec.structs.replace(
        trial.settings.colors, classes={}, samples=samples, sampling=palette.sampling, light=trial.settings.colors.light
    )
    paints = tuple(
        PaintFound(name, hex_from_bgr(np.median(measured.classes[name], axis=0).tolist()), int(count))
        for name, count in zip(trial.paints, palette.counts, strict=True)
    )
    pictures = tuple(
        PictureRead(
            len(one.robots), int((one.robots["id"] >= 0).sum()), int((one.evidence >= CLEAR_EVIDENCE).sum()),
            len(one.balls),
            tuple((round(float(row["x_px"])), round(float(row["y_px"]))) for row in one.robots[one.evidence == 0.0]),
        )
        for one in palette.judged
    )  # fmt: skip
    near = _near_paints(trial, palette, measured)
    ball = paints[trial.kinds[BALL].worn[0, 0]]
    refused, remarks = _refused(trial, palette, paints, near, pictures), _remarks(paints, ball, near, pictures)
    return ColorsFound(colors, paints, near, pictures, tuple(refused), tuple(remarks))


def paint_in_words(patches: int) -> str:
    """From what a paint's color is known. patches: that show it."""
    return f"seen on {counted(patches, 'paper')}" if patches else "known by its name alone"


def _near_paints(trial: Trial, palette: Palette, measured: Measured) -> tuple[NearPaints, ...]:
    """Pairs of seen paints that a robot could wear in each other's place, or the ball's and another one."""
    references = references_from(measured, LEARNED.spread)
    found = []
    for one, other in sorted(_confusable(trial)):
        if not (palette.counts[one] and palette.counts[other]):
            continue
        apart = references.means[one] - references.means[other]
        xx, xy, yy = (references.spreads[one] + references.spreads[other]) / 2.0
        more = max(LEAST_SPREAD**2 - (xx + yy) / 2.0, 0.0)
        xx, yy = xx + more, yy + more
        away = (yy * apart[0] ** 2 - 2.0 * xy * apart[0] * apart[1] + xx * apart[1] ** 2) / (xx * yy - xy * xy)
        if away < NEAR**2:
            found.append(NearPaints(trial.paints[one], trial.paints[other], round(float(np.sqrt(away)), 1)))
    return tuple(found)


def _confusable(trial: Trial) -> set[tuple[int, int]]:
    ball = int(trial.kinds[BALL].worn[0, 0])
    pairs = set()
    for kind in trial.kinds[:BALL]:
        for patch in kind.worn.T:
            alternatives = {*patch.tolist(), ball}
            pairs |= {(a, b) for a in alternatives for b in alternatives if a < b}
    teams = [int(kind.worn[0, 0]) for kind in trial.kinds[:BALL]]
    return pairs | {(min(teams), max(teams))}


def _refused(
    trial: Trial, palette: Palette, paints: Sequence[PaintFound], near: Sequence[NearPaints],
    pictures: Sequence[PictureRead],
) -> list[Reason]:  # fmt: skip
    if not any(one.clear for one in pictures):
        return [Reason(
            "no robot's marker is read clearly",
            "Check the pattern, the robots' height and the camera, or give pictures that show more robots.",
        )]  # fmt: skip
    worn = _worn(trial, TEAMS)
    if not any(paints[number].patches for number in worn):
        names = ", ".join(paints[number].name for number in worn)
        return [Reason(
            f"no color was learned: looked for {names}, found markers that are clear with guessed colors only",
            "Give pictures with more robots or better light, or measure the colors with `pslv colors sample`.",
        )]  # fmt: skip
    reasons = [_alike(pair, "too alike") for pair in near if pair.spreads < TOO_NEAR]
    for number, team in enumerate(TEAMS):
        unread = sum(int((one.robots["team"][one.evidence == 0.0] == number).sum()) for one in palette.judged)
        unseen = ", ".join(paints[paint].name for paint in _worn(trial, (team,)) if not paints[paint].patches)
        if unread and unseen:
            who = counted(unread, f"{team} robot")
            reasons.append(Reason(
                f"no marker that is read shows {unseen}: {who} without an id may wear it",
                "Give that paper another color if it looks like another one's; otherwise add pictures that show it.",
            ))  # fmt: skip
    return reasons


def _worn(trial: Trial, teams: Sequence[str]) -> list[int]:
    """The paints that robots of some teams may wear, each once."""
    worn = [kind.worn.ravel() for kind in trial.kinds if kind.name in teams]
    return [int(number) for number in np.unique(np.concatenate(worn))]


def _remarks(
    paints: Sequence[PaintFound], ball: PaintFound, near: Sequence[NearPaints], pictures: Sequence[PictureRead]
) -> list[Reason]:  # fmt: skip
    """ball: the paint that the ball has; robots may wear it, too."""
    reasons = [_alike(pair, "alike") for pair in near if pair.spreads >= TOO_NEAR]
    if unseen := [one.name for one in paints if not one.patches and one is not ball]:
        reasons.append(Reason(
            f"no picture shows {', '.join(unseen)}",
            "Add a picture with a robot that wears it; until then its name alone says how it looks.",
        ))  # fmt: skip
    if not ball.patches:
        balls = sum(one.balls for one in pictures)
        why = f"{counted(balls, 'ball')} read, none of them a clear disc" if balls else "no ball is read"
        reasons.append(Reason(
            f"{ball.name} could not be learned: {why}",
            "Add a picture in which the ball lies free; until then its name alone says how it looks.",
        ))  # fmt: skip
    places = [f"{place} px of picture {number}" for number, one in enumerate(pictures, 1) for place in one.unread]
    if places:
        shown, more = ", ".join(places[:MAX_PLACES]), len(places) - MAX_PLACES
        where = f"{shown} and {more} more" if more > 0 else shown
        reasons.append(Reason(
            f"something looks like a robot with these colors and is not read: at {where}",
            "Where no robot stands, mask what lies there (camera.masks), or add pictures that show it in other light.",
        ))  # fmt: skip
    return reasons


def _alike(pair: NearPaints, how: str) -> Reason:
    return Reason(
        f"{pair.one} and {pair.other} are {how}: {pair.spreads:g} spreads apart",
        f"Give one of them another paper; {NEAR:g} spreads and more are told apart in any light.",
    )
