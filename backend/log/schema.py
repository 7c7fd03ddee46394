"""The tables. A change here needs a revision in `migrations/versions`; a test compares the two."""

import msgspec
import sqlalchemy as sa
from sqlalchemy.engine.interfaces import Dialect

metadata = sa.MetaData(
    naming_convention={"pk": "pk_%(table_name)s", "uq": "uq_%(table_name)s_%(column_0_N_name)s"}
)


class JsonText(sa.types.TypeDecorator[object]):
    """JSON kept as text, byte for byte the same in SQLite and Postgres (JSONB would reorder and round)."""

    impl = sa.Text
    cache_ok = True

    def process_bind_param(self, value: object, dialect: Dialect) -> str | None:
        """Encode a value; None stays NULL."""
        del dialect
        return None if value is None else msgspec.json.encode(value).decode()

    def process_result_value(self, value: str | None, dialect: Dialect) -> object:
        """Decode what was stored."""
        del dialect
        return None if value is None else msgspec.json.decode(value)


# No foreign keys: rows of an incident are only ever written under the lock of its row, which has just been
# read, and incidents are never deleted. Checking each row again would cost the log a third of its speed.

incidents = sa.Table(
    "incidents",
    metadata,
    sa.Column("id", sa.Text, primary_key=True),
    sa.Column("name", sa.Text, nullable=False),
    sa.Column("clock", sa.Text, nullable=False),
    sa.Column("state", sa.Text, nullable=False),
    sa.Column("origin", JsonText),
    sa.Column("levels", JsonText, nullable=False),
    sa.Column("settings", JsonText, nullable=False),
    sa.Column("created", sa.Double, nullable=False),
    sa.Column("closed", sa.Double),
    sa.Column("last_seq", sa.BigInteger, nullable=False),
)

stretches = sa.Table(
    "stretches",
    metadata,
    sa.Column("incident", sa.Text, primary_key=True),
    sa.Column("number", sa.Integer, primary_key=True, autoincrement=False),
    sa.Column("after_seq", sa.BigInteger, nullable=False),
    sa.Column("since", sa.Double, nullable=False),
    sa.Column("origin", JsonText),
    sa.Column("levels", JsonText, nullable=False),
    sa.Column("settings", JsonText, nullable=False),
)

batches = sa.Table(
    "batches",
    metadata,
    sa.Column("incident", sa.Text, primary_key=True),
    sa.Column("seq", sa.BigInteger, primary_key=True, autoincrement=False),
    sa.Column("gateway", sa.Text, nullable=False),
    sa.Column("batch", sa.Text, nullable=False),
    sa.Column("received", sa.Double, nullable=False),
    sa.Column("sent", sa.Double),
    sa.Column("body", sa.LargeBinary, nullable=False),
    sa.Column("accepted", sa.Integer, nullable=False),
    sa.Column("rejected", sa.Text),
    sa.UniqueConstraint("incident", "gateway", "batch"),
)

frames = sa.Table(
    "frames",
    metadata,
    sa.Column("incident", sa.Text, primary_key=True),
    sa.Column("second", sa.BigInteger, primary_key=True, autoincrement=False),
    sa.Column("seq", sa.BigInteger, nullable=False),
    sa.Column("received", sa.Double, nullable=False),
    sa.Column("record", sa.LargeBinary, nullable=False),
)

snapshots = sa.Table(
    "snapshots",
    metadata,
    sa.Column("incident", sa.Text, primary_key=True),
    sa.Column("seq", sa.BigInteger, nullable=False),
    sa.Column("made_with", sa.Text),
    sa.Column("state", sa.LargeBinary, nullable=False),
)

leases = sa.Table(
    "leases",
    metadata,
    sa.Column("incident", sa.Text, primary_key=True),
    sa.Column("holder", sa.Text, nullable=False),
    sa.Column("epoch", sa.BigInteger, nullable=False),
    sa.Column("expires", sa.Double, nullable=False),
)
