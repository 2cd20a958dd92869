"""A service without processes for the tests of a file, and its operator."""

from collections.abc import Iterator

import httpx
import pytest

from tests.app.fake_service import FakeService, Scene, asked_by_operator


@pytest.fixture(scope="module")
def service() -> FakeService:
    return FakeService(Scene())


@pytest.fixture(scope="module")
def operator(service: FakeService) -> Iterator[httpx.Client]:
    with asked_by_operator(service) as client:
        yield client
