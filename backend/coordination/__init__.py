"""How processes work together: leases, wake-ups, fan-out."""
