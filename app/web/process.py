"""The web process: serves the page and the API from the real-time database.

It may end at any time: robots are still served, and the supervisor starts it again on the same socket.
"""

import socket

import uvicorn

from app.web.application import create_app
from vision_core.scheduling.attachment import attach

MAX_MESSAGE = 65536
"""Largest message that a page may send [bytes]: those of the 3D view are the longest."""


def main() -> None:
    """Serve until the supervisor sends SIGTERM.

    uvicorn handles SIGTERM: it closes open pages and returns. The attachment's own handler is for processes that run a
    loop of their own.
    """
    attachment = attach()
    listener = socket.socket(fileno=attachment.resources.sockets["http"])
    config = uvicorn.Config(
        create_app(attachment.store),
        access_log=False,
        log_level="warning",
        lifespan="on",
        server_header=False,
        proxy_headers=False,  # who sends X-Forwarded-For decides what it says
        timeout_graceful_shutdown=1,
        ws_max_size=MAX_MESSAGE,
        ws_per_message_deflate=False,  # a JPEG cannot be made smaller
    )
    uvicorn.Server(config).run(sockets=[listener])


if __name__ == "__main__":
    main()
