"""Task: images -> colors that follow the light. The task ``perceive`` sees with them from its next image on.

It takes its time, so it runs in a process of its own without real-time priority. Going back to the set-up (the live
setting ``colors.light.adapt``) holds the settings' colors; what was learned is remembered, so that this can be undone.
Switching the task off forgets it.
"""

from vision_core.clock import Instant
from vision_core.color.light import start_light
from vision_core.color.lookup_table import compile_color_table
from vision_core.palette.follow import Follower, Look
from vision_core.palette.reading import Palette, table_of_settings
from vision_core.rtdb import records
from vision_core.scheduling.handle import Handle, Step
from vision_core.scheduling.latest_image import Images
from vision_core.scheduling.releases import IDLE, RAN, Release, StepResult
from vision_core.types.colors import ColorTable
from vision_core.types.image import ImageFrame
from vision_core.types.palette import MAX_CHANGES, ColorChange, LivePalette, PaintShift


def start(handle: Handle) -> Step:
    """Compile the settings' colors, and load the kernels."""
    following = _Following(handle)
    images = Images(handle)
    last = 0

    def step(_release: Release) -> StepResult:
        nonlocal last
        if following.is_held():
            return IDLE
        image = images.newest()
        if image is None:
            return images.none_result
        if image.number == last:
            return IDLE
        last = image.number
        following.look(image)
        return RAN

    return step


class _Following:
    """Follows the light, and writes what is in force whenever it changes."""

    def __init__(self, handle: Handle) -> None:
        self._handle = handle
        self._table = compile_color_table(handle.settings.colors)
        self._follower = Follower(handle.settings, self._table, self._alive)
        self._follower.warm_up()
        self._start = start_light(handle.settings.colors.light)
        self._writer = handle.writer(records.palette(handle.camera.name))
        self._live = handle.reader(records.LIVE_SETTINGS)
        self._live_sequence = 0
        self._palette: Palette | None = None
        self._held = not handle.settings.colors.light.adapt
        self._changes: list[ColorChange] = []
        self._write(handle.clock.now())
        handle.when_switched(self._forget)

    def is_held(self) -> bool:
        """Are the set-up's colors held? Takes over what was changed on the page."""
        if self._live.sequence != self._live_sequence:
            self._live_sequence = self._live.sequence
            live = self._live.read(self._handle.clock.now())
            if live is not None and live.value.adapt == self._held:
                self._held = not live.value.adapt
                self._note("held" if self._held else "resumed", self._handle.clock.now())
        return self._held

    def look(self, image: ImageFrame) -> None:
        """Look at an image; the light is told before the palette is judged, which takes longer."""
        if self._follower.watch(image.pixels):
            self._note("light", image.grabbed)
        if not self._follower.is_due:
            return
        look = self._follower.look(image.pixels)
        if look.what != "kept":
            self._palette = None if look.palette.measured is None else look.palette
            self._note(look.what, image.grabbed, look)

    def _forget(self) -> None:
        self._follower.reset()
        has_changed, self._palette = self._palette is not None, None
        if has_changed or self._changes:
            self._note("start", self._handle.clock.now())

    def _alive(self, _share: float, _what: str) -> None:
        self._handle.attachment.heartbeat(self._handle.clock.now())

    def _note(self, what: str, at: Instant, look: Look | None = None) -> None:
        """Write what is in force now, with the change in the log."""
        robots, read = (len(look.palette.judged[0].robots), look.palette.read) if look else (0, 0)
        light = self._start if self._held else self._follower.light
        self._changes.append(ColorChange(self._handle.clock.now(), what, light, robots, read))
        del self._changes[:-MAX_CHANGES]
        self._write(at)

    def _write(self, at: Instant) -> None:
        changes = tuple(self._changes)
        if self._held:
            live = LivePalette(changes, self._start, True, (), b"", (), ())
        elif self._palette is None:
            live = LivePalette(changes, self._follower.light, False, (), b"", (), ())
        else:
            live = self._learned(self._palette, changes)
        self._writer.write(live, at, self._handle.clock.now())

    def _learned(self, palette: Palette, changes: tuple[ColorChange, ...]) -> LivePalette:
        new = table_of_settings(palette, self._table)
        shifts = tuple(
            PaintShift(name, _mean_of(self._table, name), _mean_of(new, name), int(count))
            for name, count in zip(self._follower.trial.paints, palette.counts, strict=True)
        )
        means, spreads = new.references.means.ravel().tolist(), new.references.spreads.ravel().tolist()
        classes = new.classes.tobytes()
        return LivePalette(changes, self._follower.light, False, shifts, classes, tuple(means), tuple(spreads))


def _mean_of(table: ColorTable, name: str) -> tuple[float, float]:
    blue_green, red_green = table.references.means[table.index(name)].tolist()
    return blue_green, red_green
