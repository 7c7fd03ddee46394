"""Frames: how a picture is presented, kept and pushed to screens."""
