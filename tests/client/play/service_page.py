"""The page of a service whose game goes on by a second with each question."""

import json
import os
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from http.server import BaseHTTPRequestHandler, HTTPServer


class ServicePage(BaseHTTPRequestHandler):
    """Answers every path."""

    questions = 0
    code = 200

    def do_GET(self) -> None:
        ServicePage.questions += 1
        count = ServicePage.questions
        game = {
            "played_s": 60.0 + count,
            "blue": {"goals": 3, "possession_s": 20.0 + count / 4},
            "yellow": {"goals": 1 + count // 3, "possession_s": 9.0 + 3 * count / 4},
            "collisions": 40 + count,
        }
        told = (
            {"detail": "no game"} if self.code != 200 else game | {"processes": [{"pid": os.getpid()}, {"pid": None}]}
        )
        body = json.dumps(told).encode()
        self.send_response(self.code)
        self.end_headers()
        self.wfile.write(body)

    def log_message(self, format: str, *args: object) -> None: ...  # noqa: A002 (the name is the library's)


@contextmanager
def served() -> Iterator[str]:
    """The address of the page."""
    ServicePage.questions, ServicePage.code = 0, 200
    server = HTTPServer(("127.0.0.1", 0), ServicePage)
    thread = threading.Thread(target=server.serve_forever)
    thread.start()
    yield f"http://127.0.0.1:{server.server_port}"
    server.shutdown()
    thread.join()
    server.server_close()
