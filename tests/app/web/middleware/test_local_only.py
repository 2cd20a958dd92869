"""Changes are accepted from this machine, from our own page, in JSON."""

from http import HTTPStatus

import pytest
from starlette.datastructures import Headers

from app.web.middleware.local_only import _refusal

JSON = {"content-type": "application/json", "content-length": "2", "host": "127.0.0.1:8000"}


def refused(client: tuple[str, int] | None = ("127.0.0.1", 5), **headers: str) -> str:
    """Why a change is refused; empty when it is not."""
    refusal = _refusal(Headers(JSON | headers), client)
    assert refusal is None or refusal[0] is HTTPStatus.FORBIDDEN
    return "" if refusal is None else refusal[1]


@pytest.mark.parametrize("host", ["127.0.0.1", "127.8.8.8", "::1"])
def test_this_machine_may_change(host: str) -> None:
    assert refused((host, 5)) == ""


@pytest.mark.parametrize("client", [("192.168.1.7", 5), ("fe80::1", 5), ("somewhere", 5), None])
def test_no_other_machine_may(client: tuple[str, int] | None) -> None:
    assert refused(client) == "changes are accepted from the server's own machine only"


def test_a_page_may_when_it_is_ours() -> None:
    assert refused(origin="http://127.0.0.1:8000") == ""
    assert refused(origin="http://localhost:8000", host="localhost:8000") == ""
    assert refused(origin="http://[::1]:8000", host="[::1]:8000") == ""


def test_a_page_of_a_name_that_leads_here_may_not() -> None:
    assert "accepted: localhost" in refused(origin="http://evil.example:8000", host="evil.example:8000")


@pytest.mark.parametrize("origin", ["http://evil.example", "null", "http://[", ""])
def test_a_foreign_page_may_not(origin: str) -> None:
    assert "may not change anything here" in refused(origin=origin)
