"""Which worker follows which incident: leases with fencing epochs, in the database.

A lease expires where its holder is silent. Each taking raises the epoch, and every write of an estimate
names its epoch, so that a worker that was only slow cannot write over its successor.
"""

import time
from collections.abc import Callable, Iterable
from contextlib import AbstractContextManager

import sqlalchemy as sa

from backend.coordination.instance import Instance, holder_text, parse_holder

LEASE_S = 10.0
RENEW_S = 3.0

leases = sa.table(
    "leases", sa.column("incident"), sa.column("holder"), sa.column("epoch"), sa.column("expires")
)

_insert_if_absent = sa.text(
    "INSERT INTO leases (incident, holder, epoch, expires) VALUES (:incident, :holder, :epoch, :expires)"
    " ON CONFLICT (incident) DO NOTHING"
)

Begin = Callable[[], AbstractContextManager[sa.Connection]]
"""Opens a transaction that writes."""


class Leases:
    """Takes, renews and gives back leases in the name of one holder; safe to use from any thread.

    Args:
        begin: opens a transaction that writes; what it raises where the database is away goes through.
        holder: the worker's name. One that starts again under its name takes its leases at once, unless the
            process that had them still runs, or ran on another machine.
        lease_s: how long a lease holds without being renewed (s).
        instance: the worker's process.
    """

    def __init__(
        self, begin: Begin, holder: str, lease_s: float = LEASE_S, instance: Instance | None = None
    ) -> None:
        self._begin = begin
        self._name = holder
        self._instance = instance or Instance.this()
        self._holder = holder_text(holder, self._instance)
        self._lease_s = lease_s

    def acquire(self, incident: str) -> int | None:
        """Take the lease of an incident.

        Returns:
            Its new epoch; None where another's lease has not expired, unless that one held it under this name
            and is sure to have ended.
        """
        with self._begin() as connection:
            now = _now(connection)
            row = connection.execute(
                sa.select(leases).where(leases.c.incident == incident).with_for_update()
            ).first()
            if row is None:
                # Two may find nothing at once: the second insert changes nothing, and finds the first's row.
                values = {
                    "incident": incident,
                    "holder": self._holder,
                    "epoch": 1,
                    "expires": now + self._lease_s,
                }
                result = connection.execute(_insert_if_absent, values)
                return 1 if result.rowcount == 1 else None
            if row.expires > now and not self._may_go_on_from(row.holder):
                return None
            epoch: int = row.epoch + 1
            connection.execute(
                sa.update(leases)
                .where(leases.c.incident == incident)
                .values(holder=self._holder, epoch=epoch, expires=now + self._lease_s)
            )
            return epoch

    def _may_go_on_from(self, holder: str) -> bool:
        name, instance = parse_holder(holder)
        if name != self._name:
            return False
        return instance is None or instance == self._instance or instance.ended(self._instance)

    def renew(self, held: Iterable[tuple[str, int]]) -> set[str]:
        """Renew leases, in one transaction.

        Args:
            held: incidents and their epochs.

        Returns:
            The incidents whose lease another has taken.
        """
        lost = set()
        with self._begin() as connection:
            expires = _now(connection) + self._lease_s
            for incident, epoch in sorted(held):
                result = connection.execute(
                    sa.update(leases)
                    .where(leases.c.incident == incident, leases.c.epoch == epoch)
                    .values(expires=expires)
                )
                if result.rowcount == 0:
                    lost.add(incident)
        return lost

    def release(self, incident: str, epoch: int) -> None:
        """Give a lease back, unless another has taken it; its row stays, so that epochs go on counting."""
        with self._begin() as connection:
            connection.execute(
                sa.update(leases)
                .where(leases.c.incident == incident, leases.c.epoch == epoch)
                .values(expires=0.0)
            )


def _now(connection: sa.Connection) -> float:
    """Unix seconds by one clock for all workers: this machine's with SQLite, the server's with Postgres."""
    if connection.dialect.name == "sqlite":
        return time.time()
    return float(connection.execute(sa.text("SELECT extract(epoch FROM clock_timestamp())")).scalar_one())
