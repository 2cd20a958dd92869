"""The web process: serves the page and the API from the real-time database.

It may end at any time: robots are still served, and the supervisor starts it again on the same socket.
"""

import socket

import uvicorn

from app.web.application import create_app
from app.web.server import prepare_process, server_config
from vision_core.scheduling.attachment import attach


def main() -> None:
    """Serve until the supervisor sends SIGTERM.

    uvicorn handles SIGTERM: it closes open pages and returns. The attachment's own handler is for processes that run a
    loop of their own.
    """
    prepare_process()
    attachment = attach()
    listener = socket.socket(fileno=attachment.resources.sockets["http"])
    uvicorn.Server(server_config(create_app(attachment.store))).run(sockets=[listener])


if __name__ == "__main__":
    main()
