"""How uvicorn serves the application: limits for strangers, nothing believed that a proxy's headers say."""

import contextlib
import logging
import resource

import uvicorn
from fastapi import FastAPI

from app.web.connections import BACKLOG, DESCRIPTORS, IDLE_S, OperatorAddresses, guarded_protocol
from app.web.log_output import BoundedHandler

MAX_MESSAGE = 65536
"""Largest message that a page may send [bytes]: those of the 3D view are the longest."""
MAX_HEADERS = 16384
"""Of a request [bytes]."""


def server_config(app: FastAPI) -> uvicorn.Config:
    """The configuration of the one server."""
    operators = app.state.operators
    assert isinstance(operators, OperatorAddresses)
    return uvicorn.Config(
        app,
        http=guarded_protocol(operators),
        backlog=BACKLOG,
        timeout_keep_alive=IDLE_S,
        h11_max_incomplete_event_size=MAX_HEADERS,
        access_log=False,
        log_config=None,
        log_level="warning",
        lifespan="on",
        server_header=False,
        proxy_headers=False,  # who sends X-Forwarded-For decides what it says
        timeout_graceful_shutdown=1,
        ws_max_size=MAX_MESSAGE,
        ws_per_message_deflate=False,  # a JPEG cannot be made smaller
    )


def prepare_process() -> None:
    """Log without ever waiting, and allow as many descriptors as strangers and we may hold."""
    logging.basicConfig(handlers=[BoundedHandler()], level=logging.WARNING, format="%(name)s: %(message)s")
    soft, hard = resource.getrlimit(resource.RLIMIT_NOFILE)
    wanted = DESCRIPTORS if hard == resource.RLIM_INFINITY else min(DESCRIPTORS, hard)
    if soft != resource.RLIM_INFINITY and soft < wanted:
        with contextlib.suppress(ValueError, OSError):
            resource.setrlimit(resource.RLIMIT_NOFILE, (wanted, hard))
