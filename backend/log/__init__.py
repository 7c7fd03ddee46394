"""The event log: schema, group commit, reading; SQLite and Postgres behind one interface."""
