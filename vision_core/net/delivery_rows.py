"""What is known of each session's deliveries: one row of a table, which compiled code and Python share.

A row is the only place that says what its session was sent, when it is due again and how it has been served so far.
"""

import numpy as np

from vision_core.clock import NS_PER_S, NS_PER_US, Instant
from vision_core.protocol.messages import MAX_LAG_S, REPORT_PERIOD_S, LagReport
from vision_core.types.tables import Table

NOT_SENT, SENT, DROPPED, REFUSED, UNREACHABLE = 0, 1, 2, 3, 4
"""Result of a row in the last frame."""
NEVER = -1
UNKNOWN = -1
DELIVERY = np.dtype(
    [
        # whose it is, where datagrams go, and how often
        ("robot", np.int64),  # index in the record of fairness
        ("noted_in", np.int64),  # the record of fairness that has counted the session: when it began
        ("descriptor", np.int64),  # of the session's socket
        ("tick_ns", np.int64),  # unit of its printed Time
        ("period_ns", np.int64),  # at least so long between two views; 0: every frame
        # what it was sent
        ("grabbed_at", np.int64),  # grab of the last view that was sent, or NEVER
        ("sent_at", np.int64),  # when that view was sent
        ("due_at", np.int64),  # with a period: the next view's place on its grid
        # counters
        ("sent", np.int64),
        ("dropped", np.int64),
        ("frames", np.int64),  # sent + dropped
        ("rank_sum", np.float64),  # sum of its places in the order of sending, each 0 first .. 1 last
        # the last frame
        ("result", np.int64),
        ("rank", np.int64),  # place in the order of sending
        # the client's last report
        ("reported_at", np.int64),  # or NEVER
        ("network_ns", np.int64),  # lag of the network, one way, or UNKNOWN
        ("client_ns", np.int64),  # lag of the client, or UNKNOWN
    ]
)
"""How one session is served. Instants are [ns of CLOCK_MONOTONIC]."""


def mean_rank(row: Table) -> float:
    """Mean place of a row in the order of sending, 0 first .. 1 last; 0.5 is fair."""
    return float(row["rank_sum"] / row["frames"]) if row["frames"] else 0.5


def note_report(row: Table, report: LagReport, boot: Instant, now: Instant) -> None:
    """Take the lags from a client's report on the last view that was sent.

    A report on another view, with an impossible value, or soon after the last report changes nothing.
    """
    tick_ns = int(row["tick_ns"])
    printed_us = (int(row["grabbed_at"]) - boot) // tick_ns * tick_ns // NS_PER_US
    if row["grabbed_at"] == NEVER or report.time_us != printed_us:
        return
    if not all(0.0 <= lag_s <= MAX_LAG_S for lag_s in (report.hold_s, report.client_s or 0.0)):
        return
    if row["reported_at"] != NEVER and now - row["reported_at"] < REPORT_PERIOD_S * NS_PER_S:
        return
    round_trip_ns = now - int(row["sent_at"]) - round(report.hold_s * NS_PER_S)
    row["network_ns"] = max(round_trip_ns, 0) // 2
    row["client_ns"] = UNKNOWN if report.client_s is None else round(report.client_s * NS_PER_S)
    row["reported_at"] = now


def new_rows(count: int) -> Table:
    """Rows of sessions that were sent nothing yet, shape (count,)."""
    rows = np.zeros(count, dtype=DELIVERY)
    for name in ("noted_in", "grabbed_at", "sent_at", "due_at", "reported_at", "network_ns", "client_ns"):
        rows[name] = NEVER
    return rows
