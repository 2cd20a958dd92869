"""The monitors' key over the API: made, published by its digest only, no login, withdrawn."""

from collections.abc import Iterator

import httpx
import pytest

from tests.app.fake_service import FakeService, Scene, asked_by_operator
from vision_core.protocol.proofs import key_digest
from vision_core.rtdb import records


@pytest.fixture(scope="module")
def service() -> FakeService:
    return FakeService(Scene())


@pytest.fixture(scope="module")
def http(service: FakeService) -> Iterator[httpx.Client]:
    with asked_by_operator(service) as client:
        yield client


def published(service: FakeService) -> str | None:
    """The digest that the task ``serve`` is told."""
    reading = records.LIVE_SETTINGS.reader(service.store).read(service.clock.now())
    assert reading is not None
    return reading.value.monitor_key


def test_a_key_is_made_replaced_and_withdrawn(http: httpx.Client, service: FakeService) -> None:
    assert http.get("/monitors").json() == {"has_key": False, "connected": []}
    first, second = (http.post("/monitors/key").json()["key"] for _ in range(2))
    assert published(service) == key_digest(second) != key_digest(first)
    assert http.get("/monitors").json()["has_key"]
    assert http.delete("/monitors/key").status_code == 204
    assert published(service) is None
    assert not http.get("/monitors").json()["has_key"]


def test_it_opens_no_page(http: httpx.Client) -> None:
    key = http.post("/monitors/key").json()["key"]
    assert http.post("/login", json={"secret": key}, headers={"Authorization": ""}).status_code == 401


def test_who_is_not_the_operator_makes_none(http: httpx.Client) -> None:
    assert http.post("/monitors/key", headers={"Authorization": ""}).status_code == 401
