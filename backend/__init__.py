"""Firethread's service: HTTP, log, sockets, processes."""
