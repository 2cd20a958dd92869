"""Short process that runs before the service starts: it checks that the tasks can work with the settings.

It reads the settings from standard input. A mistake that it finds is reported in one line; without this check it
would make a task's process crash again and again.
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
from vision_core.pipeline.venue_warnings import venue_warnings
from vision_core.pipeline.view_encoder import ViewEncoder
from vision_core.protocol.admission import Admission
from vision_core.scheduling.attachment import end_with
from vision_core.settings.schema import Settings
from vision_core.startup import WITHOUT_SOURCE


def main() -> int:
    """Check the settings, open the source and close it; exit status 2 and one line on standard error if that fails.

    What is odd about settings that are accepted is a line on standard error too.
    """
    end_with(os.getppid())  # opening a camera may take long: this process ends with the command that started it
    settings = msgspec.json.decode(sys.stdin.buffer.read(), type=Settings)
    camera = CameraSetup.from_settings(settings)
    try:
        check_tasks(settings, camera)
        for warning in venue_warnings(settings, lambda _key: "settings"):
            print(f"warning: {warning}", file=sys.stderr)
        if WITHOUT_SOURCE in sys.argv:
            return 0
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
    """Build what the tasks build from settings: pattern and colors, edge codes, subnets. Raises SettingsError."""
    Perception(settings, camera)
    ViewEncoder(settings, Instant(0))
    Admission.from_subnets(settings.admission.subnets)


if __name__ == "__main__":
    sys.exit(main())
