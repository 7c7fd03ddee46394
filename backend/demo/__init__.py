"""The demo incident, posted as gateways would."""

from backend.demo.playing import play, play_until_stopped

__all__ = ["play", "play_until_stopped"]
