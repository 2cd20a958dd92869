"""Task: images -> a palette that follows the light. The task ``perceive`` sees with it from its next image on.

It takes its time, so it runs in a process of its own without real-time priority. Switching it off brings the colors of
the settings back at once.
"""

from vision_core.clock import Instant
from vision_core.color.lookup_table import compile_color_table
from vision_core.palette.follow import Follower, Look
from vision_core.palette.reading import table_of_settings
from vision_core.palette.trial import Trial
from vision_core.rtdb import records
from vision_core.scheduling.handle import Handle, Step
from vision_core.scheduling.latest_image import Images
from vision_core.scheduling.releases import IDLE, RAN, Release, StepResult
from vision_core.types.colors import ColorTable
from vision_core.types.palette import MAX_CHANGES, LivePalette, PaintShift, PaletteChange


def start(handle: Handle) -> Step:
    """Compile the settings' colors, and load the kernels."""
    table = compile_color_table(handle.settings.colors)

    def alive(_share: float, _what: str) -> None:
        handle.attachment.heartbeat(handle.clock.now())

    follower = Follower(handle.settings, table, alive)
    follower.warm_up()
    images = Images(handle)
    palettes = handle.writer(records.palette(handle.camera.name))
    changes: list[PaletteChange] = []
    last = 0

    def write(look: Look | None, at: Instant) -> None:
        palettes.write(_record(look, table, follower.trial, changes), at, handle.clock.now())

    def back() -> None:
        follower.reset()
        if changes and changes[-1].what != "start":
            changes.append(PaletteChange(handle.clock.now(), "start", 0, 0))
            write(None, handle.clock.now())

    handle.when_switched(back)

    def step(_release: Release) -> StepResult:
        nonlocal last
        image = images.newest()
        if image is None:
            return images.none_result
        if image.number == last:
            return IDLE
        last = image.number
        look = follower.look(image.pixels)
        if look.what != "kept":
            read = look.palette.judged[0]
            changes.append(PaletteChange(handle.clock.now(), look.what, len(read.robots), look.palette.read))
            del changes[:-MAX_CHANGES]
        if look.what != "kept" or palettes.sequence == 0:
            write(look, image.grabbed)
        return RAN

    return step


def _record(look: Look | None, table: ColorTable, trial: Trial, changes: list[PaletteChange]) -> LivePalette:
    """What is in force. look: None: the colors of the settings."""
    if look is None or look.palette.measured is None:
        return LivePalette(tuple(changes), (), b"", (), ())
    new = table_of_settings(look.palette, table)
    shifts = tuple(
        PaintShift(name, _mean_of(table, name), _mean_of(new, name), int(count))
        for name, count in zip(trial.paints, look.palette.counts, strict=True)
    )
    return LivePalette(
        tuple(changes),
        shifts,
        new.classes.tobytes(),
        tuple(new.references.means.ravel().tolist()),
        tuple(new.references.spreads.ravel().tolist()),
    )


def _mean_of(table: ColorTable, name: str) -> tuple[float, float]:
    blue_green, red_green = table.references.means[table.index(name)].tolist()
    return blue_green, red_green
