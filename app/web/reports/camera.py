"""One camera, and what is seen in its newest image."""

from app.web.blackboard import ServiceSnapshot
from app.web.health.frame_path import camera_task
from app.web.reports.checks import Checks, checks_from
from vision_core.rtdb import records


class CameraReport(Checks):
    """One camera, what is seen in its newest image, and what its checks found."""

    name: str
    width_px: int
    height_px: int
    rate_hz: float
    """Images per second, as configured [1/s]."""
    measured_rate_hz: float | None
    """Images per second over the last 5 s [1/s]; null while the camera's task does not report."""
    frames: int
    """Images since the start of the service."""
    age_s: float | None
    """Time since the newest image was grabbed [s]; null before the first."""
    shutter_delay_ms: float
    """From the shutter to the grab, as configured [ms]; it adds to every lag."""
    robots: int
    """Robots in the newest image; 0 while no image is analyzed."""
    balls: int
    """Ball candidates in the newest image."""
    obstacles: int
    """Objects of robot size that are no known robot and no ball; 0 while nothing looks for them."""
    reasons: list[str]
    """Why nothing, or too little, is detected, and what to do, a line each; renewed about once a second, kept for
    5 s at most."""


def camera_from(snapshot: ServiceSnapshot) -> CameraReport:
    """The camera of the service."""
    camera, capture = snapshot.camera, snapshot.tasks.get(camera_task(snapshot).name)
    sightings = snapshot.recent(records.sightings)
    obstacles = snapshot.recent(records.obstacles)
    diagnosis = snapshot.recent(records.diagnosis)
    return CameraReport(
        name=camera.name,
        width_px=camera.size_px[0],
        height_px=camera.size_px[1],
        shutter_delay_ms=camera.shutter_delay_ms,
        rate_hz=camera.rate_hz,
        measured_rate_hz=capture.value.rate_hz if capture and capture.valid else None,
        frames=snapshot.frame.number if snapshot.frame else 0,
        age_s=snapshot.frame.age_s if snapshot.frame else None,
        robots=len(sightings.value.robots) if sightings else 0,
        balls=len(sightings.value.balls) if sightings else 0,
        obstacles=len(obstacles.value.obstacles) if obstacles else 0,
        reasons=[str(reason) for reason in diagnosis.value.reasons] if diagnosis else [],
        **dict(checks_from(snapshot)),
    )
