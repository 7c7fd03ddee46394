"""Firethread's own speed and accuracy tables."""
