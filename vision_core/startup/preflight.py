"""Process that runs for a moment before the service: can the tasks work with these settings?

Settings come on standard input. What is found here is one line for a person; found later, it would be a
process that dies again and again.
"""

import os
import sys

import msgspec

from vision_core.capture.playback import Pictures
from vision_core.capture.source import open_source
from vision_core.clock import Instant, MonotonicClock
from vision_core.errors import PslvError
from vision_core.models.camera_setup import CameraSetup
from vision_core.pipeline.perception import Perception
from vision_core.pipeline.view_encoder import ViewEncoder
from vision_core.protocol.admission import Admission
from vision_core.scheduling.attachment import end_with
from vision_core.settings.schema import Settings


def main() -> int:
    """Check the settings, open the source and close it; exit status 2 and one line on standard error if that fails."""
    end_with(os.getppid())  # a camera may take its time: nothing is left of a command that was killed
    settings = msgspec.json.decode(sys.stdin.buffer.read(), type=Settings)
    camera = CameraSetup.from_settings(settings)
    try:
        check_tasks(settings, camera)
        source = open_source(settings, camera, MonotonicClock())
        if isinstance(source, Pictures):
            for skipped in source.check():
                print(f"not played: {skipped}", file=sys.stderr)
        source.close()
    except PslvError as error:
        print(error, file=sys.stderr)
        return 2
    return 0


def check_tasks(settings: Settings, camera: CameraSetup) -> None:
    """Make what the tasks make of settings: pattern and its colors, letters, admitted subnets. Raises SettingsError."""
    Perception(settings, camera)
    ViewEncoder(settings, Instant(0))
    Admission.from_subnets(settings.admission.subnets)


if __name__ == "__main__":
    sys.exit(main())
