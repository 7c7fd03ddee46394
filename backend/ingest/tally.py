"""What has been ingested, counted for Prometheus.

The counts are plain numbers of the event loop's thread, read when somebody asks: the library's own counters
take a lock each time, at every batch three times.
"""

from collections import Counter
from collections.abc import Iterator

from prometheus_client import REGISTRY
from prometheus_client.core import CounterMetricFamily, Metric
from prometheus_client.registry import Collector

from backend.errors import FieldError
from backend.log.base import Appended


class Tally(Collector):
    """Counts batches, readings and refusals."""

    def __init__(self) -> None:
        self._batches = 0
        self._duplicates = 0
        self._readings = 0
        self._rejected: Counter[str] = Counter()
        self._refused: Counter[int] = Counter()

    def acknowledged(self, appended: Appended) -> None:
        """Count a batch that is in the log."""
        self._batches += 1
        if appended.duplicate:
            self._duplicates += 1
        else:
            self._readings += appended.accepted
            if appended.rejected:
                self._aside(appended.rejected)

    def refused(self, status: int) -> None:
        """Count a request that was answered with a problem."""
        self._refused[status] += 1

    def collect(self) -> Iterator[Metric]:
        """The counts as Prometheus takes them."""
        for name, text, count in (
            ("batches", "Batches acknowledged, those sent again included", self._batches),
            ("duplicates", "Batches that had been sent before", self._duplicates),
            ("readings", "Readings accepted", self._readings),
        ):
            yield CounterMetricFamily(f"firethread_ingest_{name}", text, value=count)
        rejected = CounterMetricFamily("firethread_ingest_rejected", "Readings set aside", labels=["code"])
        for code, count in self._rejected.copy().items():
            rejected.add_metric([code], count)
        yield rejected
        refused = CounterMetricFamily("firethread_ingest_refused", "Requests refused", labels=["status"])
        for status, count in self._refused.copy().items():
            refused.add_metric([str(status)], count)
        yield refused

    def _aside(self, rejected: tuple[FieldError, ...]) -> None:
        for fault in rejected:
            self._rejected[fault.code] += 1


tally = Tally()
"""The process's own; `backend.ingest.route` counts in it, and it is registered once."""
REGISTRY.register(tally)
