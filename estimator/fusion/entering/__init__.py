"""Who is there, and where each begins: told, at the base, dropped, or found by ranges and signals."""
