"""Task: sightings -> what the robots cover in the picture, and whether the ball may be hidden behind one."""

from vision_core.pipeline.robot_contours import RobotContours
from vision_core.rtdb import records
from vision_core.scheduling.handle import Handle, Step
from vision_core.scheduling.releases import IDLE, RAN, Release, StepResult
from vision_core.types.regions import Finding


def start(handle: Handle) -> Step:
    """Prepare the robots' sizes."""
    camera = handle.camera
    contours = RobotContours(handle.settings, camera)
    sightings = handle.reader(records.sightings(camera.name))
    worlds = handle.reader(records.WORLD)
    writer = handle.writer(records.contours(camera.name))
    last_number = 0
    ball_m: tuple[float, float] | None = None

    def step(_release: Release) -> StepResult:
        nonlocal last_number, ball_m
        now = handle.clock.now()
        timed, world = sightings.read(now), worlds.read(now)
        if timed is None or not timed.valid or timed.value.frame_number == last_number:
            return IDLE
        seen = timed.value
        last_number = seen.frame_number
        if world is not None and world.valid and world.value.ball is not None:
            ball_m = world.value.ball.x_m, world.value.ball.y_m
        found = contours.found(seen.robots, is_ball_seen=bool(seen.balls), ball_m=ball_m)
        writer.write(Finding(camera.name, seen.frame_number, seen.grabbed, found), seen.grabbed, handle.clock.now())
        return RAN

    return step
