"""A camera that is none: PSLV in the place of a robot's on-board camera, with the calls of OpenCV's ``VideoCapture``.

    from vision_core.client.camera import Camera

    camera = Camera("127.0.0.1", 6000, "blue", 3)  # instead of: camera = cv2.VideoCapture(0)
    while True:
        ok, picture = camera.read()

Pictures are drawn from the newest view (``panorama``): 320x240, blue green red, robots in their team's color. As with a
device, what goes wrong is no exception: ``isOpened`` and ``read`` say no, and the logger "vision_core.client" says why.
"""

import logging
from dataclasses import replace

import numpy as np

from vision_core.client.connecting import connect
from vision_core.client.connection import Connection
from vision_core.client.panorama import HEIGHT_PX, WIDTH_PX, draw_view
from vision_core.client.view import View
from vision_core.errors import PslvError
from vision_core.geometry import Bytes
from vision_core.models.mirror import Mirror
from vision_core.protocol.options import MAX_RATE_HZ, Options
from vision_core.types.objects import Team

CAP_PROP_POS_MSEC, CAP_PROP_FRAME_WIDTH, CAP_PROP_FRAME_HEIGHT, CAP_PROP_FPS = 0, 3, 4, 5
"""OpenCV's numbers of the properties that ``get`` knows."""
MS_PER_S = 1000.0

log = logging.getLogger("vision_core.client")


class Camera:
    """The views of a robot as pictures.

    rate_hz: at most so many a second, None: one per frame of the ceiling camera; mirror: of your own, None: that of the
    server's field; timeout_s: how long to wait for the server's answer, and for a picture.
    """

    def __init__(
        self,
        host: str,
        port: int,
        team: Team | str,
        number: int,
        *,
        rate_hz: int | None = None,
        mirror: Mirror | None = None,
        timeout_s: float = 5.0,
    ) -> None:
        self.view: View | None = None
        """The view that the last picture shows."""
        self._robot = host, port, team, number
        self._options = Options(types="team", rate_hz=rate_hz, mirror=mirror)
        self._timeout_s = timeout_s
        self._period_s = 0.0
        self._connection: Connection | None = None
        self._open()

    def isOpened(self) -> bool:  # noqa: N802 (OpenCV's name)
        """The server has granted the session and not ended it."""
        return self._connection is not None

    def grab(self) -> bool:
        """Wait for the next view; of several that have arrived, only the newest counts."""
        if self._connection is None:
            return False
        try:
            view = self._connection.latest() or self._connection.receive(self._timeout_s)
            view = self._connection.latest() or view
        except PslvError as error:
            self.release()
            log.warning("%s", error)
            return False
        if view is None:
            log.warning("no view within %g s: does the ceiling camera see the robot?", self._timeout_s)
            return False
        if self.view is not None and view.time_s > self.view.time_s:
            period_s = view.time_s - self.view.time_s
            self._period_s = min(self._period_s or period_s, period_s)
        self.view = view
        return True

    def retrieve(self) -> tuple[bool, Bytes | None]:
        """The picture of the view that ``grab`` has taken: blue green red, shape (240, 320, 3)."""
        if self._connection is None or self.view is None:
            return False, None
        picture = draw_view(self.view, self._connection.mirror, self._options)
        return True, np.ascontiguousarray(picture[..., ::-1])

    def read(self) -> tuple[bool, Bytes | None]:
        """Wait for the next picture, as ``cv2.VideoCapture.read``: (False, None) when none comes in time."""
        return self.retrieve() if self.grab() else (False, None)

    def release(self) -> None:
        """End the session."""
        if self._connection is not None:
            self._connection.close()
        self._connection = None

    def get(self, prop: int) -> float:
        """Width, height, pictures per second and time of the picture [ms]; 0 for what is not known."""
        known = {
            CAP_PROP_FRAME_WIDTH: float(WIDTH_PX),
            CAP_PROP_FRAME_HEIGHT: float(HEIGHT_PX),
            CAP_PROP_FPS: float(self._options.rate_hz or (self._period_s and 1.0 / self._period_s)),
            CAP_PROP_POS_MSEC: MS_PER_S * self.view.time_s if self.view is not None else 0.0,
        }
        return known.get(prop, 0.0)

    def set(self, prop: int, value: float) -> bool:
        """Whether the property has the value now. Only the pictures per second change: 1..1000, in whole numbers."""
        if prop == CAP_PROP_FPS and 1.0 <= value <= MAX_RATE_HZ and self._connection is not None:
            self.release()
            self._options = replace(self._options, rate_hz=round(value))
            self._open()
            return self.isOpened()
        return prop in (CAP_PROP_FRAME_WIDTH, CAP_PROP_FRAME_HEIGHT) and value == self.get(prop)

    def _open(self) -> None:
        host, port, team, number = self._robot
        try:
            self._connection = connect(host, port, team, number, options=self._options, timeout_s=self._timeout_s)
        except (PslvError, ValueError) as error:
            log.warning("%s", error)
