"""Incidents: opening, changing, closing, listing."""
