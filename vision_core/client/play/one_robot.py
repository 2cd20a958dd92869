"""One robot, driven by a controller: how an example is run by itself."""

from vision_core.client.connecting import connect
from vision_core.client.play.controllers import ControllerKind, options_of


def drive_robot(
    kind: ControllerKind,
    team: str = "blue",
    number: str = "3",
    host: str = "127.0.0.1",
    port: str = "6000",
    views: str = "300",
) -> None:
    """Let a controller drive a robot for so many views, and print what it decides. Raises ConnectionRefused."""
    with connect(host, int(port), team, int(number), options=options_of(kind)) as connection:
        controller = kind(connection.robot)
        for count, view in enumerate(connection, start=1):
            drive = controller.decide(view)
            connection.follow(drive)
            print(f"{view.time_s:.3f} s: {view.summary} -> {drive.vx_m_s:+.2f} {drive.vy_m_s:+.2f} m/s")
            if count == int(views):
                break
