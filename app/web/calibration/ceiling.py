"""The ceiling camera's picture of the instant at which an on-board picture is given."""

import time

from app.web.blackboard import Blackboard
from app.web.calibration.pictures import CalibrationPictures
from vision_core.clock import seconds_between


def keep_ceiling(pictures: CalibrationPictures, number: int, blackboard: Blackboard) -> bool:
    """Keep the camera's newest picture beside an on-board picture; False: there is none yet. Raises RequestRefused."""
    newest = blackboard.picture()
    if newest is not None:
        age_s = seconds_between(newest.grabbed, blackboard.now())
        pictures.keep_ceiling(number, newest.pixels, time.time() - age_s)
    return newest is not None
