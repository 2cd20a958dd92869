"""What each topic of the live connection contains: from one snapshot of the database to JSON, or to bytes."""

import base64
import struct
from collections.abc import Iterator
from typing import Any

import msgspec
import numpy as np

from app.web.blackboard import Picture, ServiceSnapshot, Timings
from app.web.configuration.configuration import Configuration
from app.web.health.monitor import HealthMonitor
from app.web.reports.field import Outlines
from app.web.reports.log import log_from
from app.web.reports.status import status_from
from app.web.reports.tasks import tasks_from
from app.web.reports.timing import timing_from
from app.web.routes.match import match_from
from vision_core.clock import NS_PER_US, Instant, seconds_between
from vision_core.native.opencv import encode_jpeg, shrink
from vision_core.protocol.edge_codes import EdgeCodes
from vision_core.protocol.encoding import encode_see
from vision_core.protocol.messages import Ball, See
from vision_core.rtdb import records
from vision_core.rtdb.items import Timed
from vision_core.rtdb.log_record import ServiceLog
from vision_core.types.objects import Team
from vision_core.types.overlay import Overlay
from vision_core.types.tables import TEAM_NUMBER
from vision_core.types.tracks import World
from vision_core.types.views import Views, ViewSnapshot

PICTURE_KIND, VIEWS_KIND = 1, 3
HEADER = struct.Struct("<B3xId")
"""Of a binary message: kind; number of the frame, or how many robots follow; grab of the frame [s]."""
VIEW_HEADER = struct.Struct("<BBhhh")
"""Of one robot: team (0 blue, 1 yellow), number; distance [px], direction and size [deg] of the ball, -1: hidden."""
MAX_WIDTH_PX = 960
JPEG_QUALITY = 75
DIGITS = 4
"""Of metres and radians: a tenth of a millimetre."""


def encoded(topic: str, boot: Instant, now: Instant, **content: Any) -> str:
    """A JSON message."""
    return msgspec.json.encode({"topic": topic, "now_s": seconds_between(boot, now), **content}).decode()


def status_message(snapshot: ServiceSnapshot, monitor: HealthMonitor, configuration: Configuration, pages: int) -> str:
    """The whole service and the match."""
    match = match_from(configuration)
    status = status_from(snapshot, monitor.judge(snapshot)).model_dump()
    return encoded(
        "status",
        snapshot.service.boot,
        snapshot.now,
        pages=pages,
        revision=match.revision,
        match=match.model_dump(),
        status=status,
    )


def world_message(boot: Instant, now: Instant, world: Timed[World] | None) -> str:
    """Robots, ball and obstacles on the floor."""
    if world is None:
        return encoded("world", boot, now, grabbed_s=0.0, valid=False, robots=[], ball=None, obstacles=[])
    value = world.value
    ball = value.ball
    return encoded(
        "world",
        boot,
        now,
        grabbed_s=seconds_between(boot, value.at),
        valid=world.valid,
        robots=list(_robots(value)),
        ball=ball
        and {
            "x_m": round(ball.x_m, DIGITS),
            "y_m": round(ball.y_m, DIGITS),
            "vx_m_s": round(ball.vx_m_s, DIGITS),
            "vy_m_s": round(ball.vy_m_s, DIGITS),
            "hidden": ball.hidden,
            "age_s": seconds_between(ball.seen, value.at),
        },
        obstacles=[
            {"x_m": round(o.x_m, DIGITS), "y_m": round(o.y_m, DIGITS), "radius_m": round(o.radius_m, DIGITS)}
            for o in value.obstacles
        ],
    )


def _robots(world: World) -> Iterator[dict[str, Any]]:
    for robot in world.robots:
        variance = robot.position_sd_m**2
        yield {
            "team": robot.team.value,
            "id": robot.id,
            "x_m": round(robot.x_m, DIGITS),
            "y_m": round(robot.y_m, DIGITS),
            "heading_rad": round(robot.heading_rad, DIGITS),
            "heading_sd_rad": round(robot.heading_sd_rad, DIGITS),
            "covariance": [variance, 0.0, variance],
            "vx_m_s": round(robot.vx_m_s, DIGITS),
            "vy_m_s": round(robot.vy_m_s, DIGITS),
            "age_s": seconds_between(robot.seen, world.at),
        }


def views_message(boot: Instant, views: Timed[Views] | None) -> bytes:
    """What every robot sees, in pixels of its team's mirror."""
    if views is None:
        return HEADER.pack(VIEWS_KIND, 0, 0.0)
    value = views.value
    parts = [HEADER.pack(VIEWS_KIND, len(value.views), seconds_between(boot, value.at))]
    for view in value.views:
        ball = view.ball_px, view.ball_direction_deg, view.ball_size_deg
        parts += [VIEW_HEADER.pack(TEAM_NUMBER[view.team], view.number, *ball), view.kinds, view.px]
    return b"".join(parts)


def robot_view_message(
    topic: str, boot: Instant, now: Instant, views: Timed[Views] | None, robot: tuple[Team, int], codes: EdgeCodes
) -> str:
    """What one robot sees, with the message for a program that has chosen no options."""
    found = next((v for v in views.value.views if (v.team, v.number) == robot), None) if views else None
    if views is None or found is None:
        grabbed_s = seconds_between(boot, views.value.at) if views else 0.0
        return encoded(topic, boot, now, grabbed_s=grabbed_s, valid=False, message="", kinds="", px="", **_ball(None))
    at_s = seconds_between(boot, views.value.at)
    return encoded(
        topic,
        boot,
        now,
        grabbed_s=at_s,
        valid=views.valid,
        message=see_text(found, views.value.at, boot, codes),
        kinds=base64.b64encode(found.kinds).decode(),
        px=base64.b64encode(found.px).decode(),
        **_ball(found),
    )


def _ball(view: ViewSnapshot | None) -> dict[str, int]:
    if view is None:
        return {"ball_px": -1, "ball_direction_deg": 0, "ball_size_deg": 0}
    return {
        "ball_px": view.ball_px,
        "ball_direction_deg": view.ball_direction_deg,
        "ball_size_deg": view.ball_size_deg,
    }


def see_text(view: ViewSnapshot, at: Instant, boot: Instant, codes: EdgeCodes) -> str:
    """The ``see`` message of a view in the paper's form (section 3.2), as a program without options gets it."""
    letters = codes["same"][np.frombuffer(view.kinds, dtype=np.uint8)].tobytes()
    edges = "".join(f"{letter:c}{px:02x}" for letter, px in zip(letters, view.px, strict=True)).encode("ascii")
    ball = Ball(view.ball_px, view.ball_direction_deg, view.ball_size_deg)
    return encode_see(See((at - boot) // NS_PER_US, edges, ball)).decode("ascii")


def picture_message(picture: Picture, boot: Instant) -> bytes:
    """A picture, reduced to the size of a page."""
    header = HEADER.pack(PICTURE_KIND, picture.number & 0xFFFFFFFF, seconds_between(boot, picture.grabbed))
    return header + encode_jpeg(shrink(picture.pixels, MAX_WIDTH_PX), JPEG_QUALITY)


def sightings_message(snapshot: ServiceSnapshot, outlines: Outlines) -> str:
    """What is seen in the newest picture, in its pixels."""
    sightings, obstacles = snapshot.of(records.sightings), snapshot.of(records.obstacles)
    return encoded(
        "sightings",
        snapshot.service.boot,
        snapshot.now,
        sightings=sightings,
        outlines_px=outlines.of_robots(sightings.value.robots) if sightings else [],
        obstacles=obstacles,
        obstacle_outlines_px=outlines.of_obstacles(obstacles.value.obstacles) if obstacles else [],
    )


def overlay_message(topic: str, boot: Instant, now: Instant, overlay: Overlay, content: object) -> str:
    """One layer of an overlay; bytes become base64, and nan null."""
    grabbed_s = seconds_between(boot, overlay.grabbed)
    return encoded(topic, boot, now, frame=overlay.frame_number, grabbed_s=grabbed_s, content=content)


def timing_message(snapshot: ServiceSnapshot, timings: Timings) -> str:
    """How the tasks run."""
    return encoded(
        "timing",
        snapshot.service.boot,
        snapshot.now,
        tasks=[task.model_dump() for task in tasks_from(snapshot)],
        timing=timing_from(timings, snapshot.camera.shutter_delay_ms).model_dump(),
    )


def log_message(boot: Instant, now: Instant, log: ServiceLog) -> str:
    """What the processes have printed."""
    return encoded("log", boot, now, **log_from(log).model_dump())
