"""Set up on one picture, tried on all others: what ``pslv evaluate --cross-light`` prints.

For every picture of a truth file the colors are found in it alone, as ``pslv colors find`` does. With them every other
picture is read: without any adaptation; with the light measured and taken out; with the palette changed as the running
service changes it, when fewer robots are read than in the picture of the set-up: learned on from what is read, or found
anew; and, beside, from no palette at all. No color of the venue's file is used.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Any, NamedTuple

from vision_core.evaluation.lights import LightScore, add_picture
from vision_core.evaluation.truth_files import PictureTruth
from vision_core.geometry import Bytes
from vision_core.native.opencv import read_picture
from vision_core.palette.find import find_palette, refined
from vision_core.palette.light import light_from
from vision_core.palette.reading import Palette, judged_again
from vision_core.palette.trial import Judged, Picture, Trial
from vision_core.settings.schema import Settings
from vision_core.types.colors import Light
from vision_core.types.tables import TEAMS

MODES = ("no adaptation", "light", "light and palette", "no palette")


@dataclass(frozen=True, slots=True)
class Pair:
    """How one picture is read with colors from another one."""

    set_up: str
    tried: str
    scores: dict[str, LightScore]
    """By mode."""

    def row(self) -> dict[str, Any]:
        """As JSON can hold it."""
        return {"set_up": self.set_up, "tried": self.tried, **{mode: one.row() for mode, one in self.scores.items()}}


def score_across(truth: Sequence[PictureTruth], settings: Settings, tolerance_px: float) -> Iterator[Pair]:
    """The score of every pair of pictures, as it is done. Raises SourceError for a picture that cannot be read."""
    size = settings.camera.width_px, settings.camera.height_px
    pixels = [read_picture(picture.file, size) for picture in truth]
    alone = []
    for shown in pixels:
        trial = Trial(settings, light_from(shown, settings))
        own = trial.prepared(shown)
        light = trial.light
        alone.append(_Way(trial, own, light, find_palette(trial, [own])))
    for one, set_up in enumerate(alone):
        for other, picture in enumerate(truth):
            if other != one:
                ways = _ways(set_up, pixels[other], alone[other])
                yield Pair(
                    truth[one].file.name,
                    picture.file.name,
                    {mode: _score(mode, way, picture, tolerance_px) for mode, way in zip(MODES, ways, strict=True)},
                )


class _Way(NamedTuple):
    """A picture in some light, and the palette that it is read with."""

    trial: Trial
    picture: Picture
    light: Light
    palette: Palette


def _ways(set_up: _Way, pixels: Bytes, alone: _Way) -> tuple[_Way, ...]:
    """A picture in every mode. set_up: of another picture; alone: found in this one."""
    trial = set_up.trial
    as_it_is, lit = trial.prepared(pixels, set_up.light), trial.prepared(pixels)
    light = judged_again(trial, [lit], set_up.palette)
    with_light = followed = _Way(trial, lit, trial.light, light)
    if followed.palette.read < set_up.palette.read:
        learned = refined(trial, [lit], light)
        if learned.is_better_than(followed.palette):
            followed = followed._replace(palette=learned)
    if followed.palette.read < set_up.palette.read and alone.palette.is_better_than(followed.palette):
        followed = alone
    return set_up._replace(picture=as_it_is), with_light, followed, alone


def _score(mode: str, way: _Way, truth: PictureTruth, tolerance_px: float) -> LightScore:
    score = LightScore(mode)
    way.trial.use(way.palette.table)
    add_picture(score, truth, _found(way.trial.read(way.picture)), tolerance_px)
    return score


def _found(judged: Judged) -> dict[str, Any]:
    """What was read, as a table of ``detect_files``."""
    robots = [
        {
            "team": str(TEAMS[robot["team"]]),
            "id": int(robot["id"]) if robot["id"] >= 0 else None,
            "x_px": float(robot["x_px"]),
            "y_px": float(robot["y_px"]),
        }
        for robot in judged.robots
    ]
    return {"robots": robots, "balls": [], "reasons": []}


def summary(pairs: Sequence[Pair]) -> list[dict[str, Any]]:
    """Per mode: mean and worst share of robots found and of ids right over the pairs, wrong ids, false robots."""
    rows = []
    for mode in MODES:
        scores = [pair.scores[mode] for pair in pairs]
        found = [one.found / one.robots for one in scores if one.robots]
        right = [one.right / one.ids for one in scores if one.ids]
        ids = sum(one.ids for one in scores)
        rows.append(
            {
                "mode": mode,
                "pairs": len(scores),
                "found_mean": _mean(found),
                "found_worst": min(found, default=None),
                "right_mean": _mean(right),
                "right_worst": min(right, default=None),
                "wrong": sum(one.wrong for one in scores),
                "ids": ids,
                "false": sum(one.false for one in scores),
            }
        )
    return rows


def _mean(shares: Sequence[float]) -> float | None:
    return sum(shares) / len(shares) if shares else None
