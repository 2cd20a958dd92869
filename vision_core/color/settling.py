"""The light that a running service sees with: it follows what is measured once that has settled.

A lamp that flickers, a hand over the field and a camera that still adjusts itself change the light from look to look;
such lights are waited for. A light is taken when some looks one after the other agree on it, the first one at once.
"""

from vision_core.color.light import MIN_GAIN_CHANGE, Lighting, gain_distance, settled, start_light
from vision_core.geometry import Bytes
from vision_core.models.camera_setup import CameraSetup
from vision_core.settings.schema import Settings
from vision_core.types.colors import Light

SAME = 2.0 * MIN_GAIN_CHANGE
"""Two looks agree when the logarithms of their gains differ by no more."""
AGREEING = 3
"""So many looks must agree."""


class SettlingLight:
    """Follows the light of one camera."""

    def __init__(self, settings: Settings, camera: CameraSetup) -> None:
        self._settings = settings.colors.light
        self._lighting = Lighting(settings, camera)
        self.reset()

    def reset(self) -> None:
        """Begin again with the light of the set-up."""
        self.light = start_light(self._settings)
        """In force."""
        self._before = self.light
        self._refused: Light | None = None
        self._agreed: Light | None = None
        self._agreeing = 0

    def refuse(self) -> None:
        """Go back to the light before the last one, and do not take that again until it is reconsidered or differs."""
        self._refused, self.light = self.light, self._before

    def reconsider(self) -> None:
        """Take the light that was refused when it is measured once more."""
        self._refused = None

    def look(self, pixels: Bytes) -> bool:
        """Measure the light of the newest picture, shape (height, width, 3); False while it has not settled."""
        now = self._lighting.measure(pixels)
        if self._agreed is None:
            self._agreeing = AGREEING
        elif gain_distance(now, self._agreed) <= SAME and (now.reason is None) == (self._agreed.reason is None):
            self._agreeing += 1
        else:
            self._agreeing = 1
        self._agreed, wanted = now, settled(self.light, now, self._settings)
        if self._refused is not None and gain_distance(wanted, self._refused) <= SAME:
            return True
        if self._agreeing >= AGREEING:
            self._before, self._refused, self.light = self.light, None, wanted
        return self.light.gain_bgr == wanted.gain_bgr
