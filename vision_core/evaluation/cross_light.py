"""Set up on one picture, tried on all others: what ``pslv evaluate --cross-light`` prints.

For every picture of a truth file the colors are found in it alone, as ``pslv colors find`` does. With them every other
picture is read: without any adaptation; with the light measured and taken out; with the palette learned on from what is
read; and, beside, from no palette at all. No color of the venue's file is used.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Any

from vision_core.evaluation.lights import LightScore, add_picture
from vision_core.evaluation.truth_files import PictureTruth
from vision_core.native.opencv import read_picture
from vision_core.palette.find import find_palette, refined
from vision_core.palette.light import light_from
from vision_core.palette.reading import Palette, judged_again
from vision_core.palette.trial import Judged, Trial
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
    alone: list[tuple[Palette, Trial, Light]] = []
    for shown in pixels:
        trial = Trial(settings, light_from(shown, settings))
        own = trial.prepared(shown)
        alone.append((find_palette(trial, [own]), trial, trial.light))
    for one, (palette, trial, set_up_light) in enumerate(alone):
        for other, picture in enumerate(truth):
            if other == one:
                continue
            lit = trial.prepared(pixels[other])
            as_it_is = trial.prepared(pixels[other], set_up_light)
            plain = judged_again(trial, [as_it_is], palette)
            light = judged_again(trial, [lit], palette)
            learned = refined(trial, [lit], light)
            best = max((light, learned, alone[other][0]), key=lambda found: found.score)
            readings = dict(zip(MODES, (plain, light, best, alone[other][0]), strict=True))
            scores = {}
            for mode, reading in readings.items():
                scores[mode] = LightScore(mode)
                add_picture(scores[mode], picture, _found(reading.judged[0]), tolerance_px)
            yield Pair(truth[one].file.name, picture.file.name, scores)


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
