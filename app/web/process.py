"""Process: the page and the API. Reads the database, writes how it does itself and what people want changed.

It may die at any time: robots are served on, and the supervisor starts it again on the same socket.
"""

import socket

import uvicorn

from app.web.application import create_app
from vision_core.scheduling.attachment import attach

MAX_MESSAGE = 1024
"""What a page may send [bytes]: it says no more than "next"."""


def main() -> None:
    """Serve until the supervisor says stop.

    While it serves, uvicorn takes SIGTERM, closes open pages and returns; the attachment's own handler
    is for processes that loop by themselves.
    """
    attachment = attach()
    listener = socket.socket(fileno=attachment.resources.sockets["http"])
    config = uvicorn.Config(
        create_app(attachment.store),
        access_log=False,
        log_level="warning",
        lifespan="on",
        server_header=False,
        timeout_graceful_shutdown=1,
        ws_max_size=MAX_MESSAGE,
        ws_per_message_deflate=False,  # a JPEG cannot be made smaller
    )
    uvicorn.Server(config).run(sockets=[listener])


if __name__ == "__main__":
    main()
