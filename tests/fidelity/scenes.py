"""Worlds made by hand, and their truth: no picture is rendered."""

from dataclasses import replace

import numpy as np

from vision_core.capture.synthetic.world import Snapshot
from vision_core.fidelity.causes import FINER, Cause, Evidence, explain
from vision_core.fidelity.ceiling import CeilingSide
from vision_core.fidelity.experiment import evidence
from vision_core.fidelity.onboard import OnboardSide
from vision_core.fidelity.reports import Report
from vision_core.fidelity.worlds import ONBOARD_PX, Setup
from vision_core.onboard.scene import snapshot_of

FAR_BALL = (-1.2, -1.0)


class Lab:
    """Both sides of a setup, without their pictures."""

    def __init__(self, field: str = "3 m") -> None:
        setup = Setup(field, "640x480", ONBOARD_PX[field], tall=False)
        self.ceiling = CeilingSide(setup)
        self.onboard = OnboardSide(setup, setup.mirror)
        self.mirror = setup.mirror

    def snapshot(self, *robots: tuple[float, float, float], ball: tuple[float, float] = FAR_BALL) -> Snapshot:
        """The first robot is the viewer; the next ones are of yellow; those that are left out stand far outside."""
        poses = np.tile([30.0, 30.0, 0.0], (len(self.onboard.camera.worn), 1))
        poses[0] = robots[0]
        poses[-len(robots) + 1 :][: len(robots) - 1] = np.array(robots[1:]).reshape(-1, 3)
        return snapshot_of(poses, ball)

    def truth(self, snapshot: Snapshot) -> Evidence:
        """The truth of a world."""
        return evidence(snapshot, self.onboard.scene(snapshot), self.ceiling, self.onboard)


def exact(truth: Evidence) -> Report:
    """What an on-board module without error reports."""
    return replace(
        truth.exact, letters=truth.exact.letters[::FINER].copy(), radii_px=truth.exact.radii_px[::FINER].copy()
    )


def changed(report: Report, direction: int, letter: str, radius_px: float, beside: int = 2) -> Report:
    """A report with another edge in a direction and so many neighbors on either side."""
    letters, radii = report.letters.copy(), report.radii_px.copy()
    for place in range(direction - beside, direction + beside + 1):
        letters[place % len(letters)], radii[place % len(radii)] = letter, radius_px
    return replace(report, letters=letters, radii_px=radii)


def cause_at(direction: int, told: Report, seen: Report, truth: Evidence) -> Cause | None:
    """Why two reports disagree in a direction."""
    return explain(told, seen, truth)[direction]
