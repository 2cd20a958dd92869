"""Times are told as they were counted: histograms, quantiles, and for Prometheus."""

from collections.abc import Iterator

import httpx
import numpy as np
import pytest
from prometheus_client.parser import text_string_to_metric_families

from app.web.reports.timing import histogram_from
from tests.app.fake_service import FakeService, PageServer, Scene
from tests.app.fake_tasks import COUNTED, Condition
from vision_core.clock import NS_PER_MS
from vision_core.timing.histogram import BINS, Histograms, decode, quantile_s

NAMES = ("any",)


def histogram_of(durations_ms: list[float]) -> Histograms:
    """Of some durations."""
    histograms = Histograms(NAMES)
    for duration_ms in durations_ms:
        histograms.add("any", round(duration_ms * NS_PER_MS))
    return histograms


@pytest.fixture(scope="module")
def service() -> FakeService:
    service = FakeService(Scene(condition=Condition(reporting=False, silent=("lines",))))
    service.write_frame()
    service.write_processes()
    service.write_tasks()
    return service


@pytest.fixture(scope="module")
def http(service: FakeService) -> Iterator[httpx.Client]:
    server = PageServer(service)
    server.start()
    with httpx.Client(base_url=f"http://{server.address}") as client:
        yield client
    server.stop()


def test_a_histogram_is_its_filled_bins_and_its_quantiles() -> None:
    durations_ms = [1.0] * 98 + [8.0, 30.0]
    counts = decode(NAMES, histogram_of(durations_ms).encode())["any"]
    told = histogram_from(counts)
    assert told.count == 100
    assert sum(count for _, count in told.bins) == 100
    assert [count for _, count in told.bins] == [98, 1, 1]
    for (upper_ms, _), longest_ms in zip(told.bins, (1.0, 8.0, 30.0), strict=True):
        assert longest_ms < upper_ms <= 1.035 * longest_ms
    assert told.p50 == pytest.approx(1e3 * (quantile_s(counts, 0.5) or 0.0), abs=1e-6)
    assert told.p99 == pytest.approx(8.0, rel=0.035)
    assert told.max == told.bins[-1][0]


def test_no_durations_have_no_quantiles() -> None:
    told = histogram_from(np.zeros(BINS, dtype=np.uint64))
    assert (told.count, told.p50, told.p99_9, told.max, told.bins) == (0, None, None, None, [])


def test_the_api_tells_every_task_and_the_lags(http: httpx.Client, service: FakeService) -> None:
    timing = http.get("/api/v1/timing").json()
    names = [task.name for task in service.tasks if task.name != "lines"]
    assert {task["name"] for task in timing["tasks"]} <= set(names)
    assert {"capture", "serve", "diagnose"} <= {task["name"] for task in timing["tasks"]}
    perceive = next(task for task in timing["tasks"] if task["name"] == "perceive")
    assert perceive["valid"] is True
    assert perceive["response"]["unit"] == "ms"
    assert perceive["response"]["count"] == COUNTED
    assert perceive["response"]["p50"] == pytest.approx(1.9, rel=0.1)
    assert perceive["response"]["p50"] < perceive["response"]["p99"] <= perceive["response"]["max"]
    assert timing["lags"]["server"]["p50"] == pytest.approx(12.4, rel=0.1)
    assert timing["lags"]["network"] is timing["lags"]["client"] is None, "nobody reports them"
    assert timing["lags"]["shutter_delay_ms"] == 0.0


def test_prometheus_reads_our_metrics(http: httpx.Client, service: FakeService) -> None:
    service.write_tasks()
    service.write_frame()
    answer = http.get("/metrics")
    assert answer.headers["content-type"] == "text/plain; version=0.0.4; charset=utf-8"
    families = {family.name: family for family in text_string_to_metric_families(answer.text)}
    assert families["pslv_task_runs"].type == "counter"
    runs = {sample.labels["task"]: sample for sample in families["pslv_task_runs"].samples}
    assert runs["boundary"].labels["process"] == "watch"
    assert "lines" not in runs, "it has never spoken"
    (ready,) = families["pslv_ready"].samples
    assert ready.value == 1.0
    restarts = {sample.labels["process"]: sample.value for sample in families["pslv_process_restarts"].samples}
    assert restarts["spare-1"] == 0.0
    assert {sample.labels["team"]: sample.value for sample in families["pslv_clients"].samples} == {
        "blue": 5.0,
        "yellow": 5.0,
    }
    assert {sample.labels["part"] for sample in families["pslv_lag_seconds"].samples} == {"server"}


def test_buckets_rise_to_the_count_and_the_sum_is_right(http: httpx.Client, service: FakeService) -> None:
    service.write_tasks()
    families = {family.name: family for family in text_string_to_metric_families(http.get("/metrics").text)}
    samples = [
        sample for sample in families["pslv_task_response_seconds"].samples if sample.labels["task"] == "perceive"
    ]
    buckets = [sample for sample in samples if sample.name.endswith("_bucket")]
    assert 24 <= len(buckets) <= 48
    bounds = [float(sample.labels["le"]) for sample in buckets]
    assert bounds == sorted(bounds)
    values = [sample.value for sample in buckets]
    assert values == sorted(values)
    assert values[-1] == COUNTED
    total = next(sample.value for sample in samples if sample.name.endswith("_sum"))
    assert total / COUNTED == pytest.approx(1.9e-3 * np.exp(0.25**2 / 2), rel=0.05)


def test_open_metrics_for_who_asks_for_it(http: httpx.Client) -> None:
    answer = http.get("/metrics", headers={"accept": "application/openmetrics-text; version=1.0.0"})
    assert answer.headers["content-type"].startswith("application/openmetrics-text; version=1.0.0")
    assert answer.text.endswith("# EOF\n")
