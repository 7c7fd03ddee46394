"""The time of a replay: where it is, how fast it goes, and what the viewer does with it."""


class ReplayClock:
    """Incident time as a function of wall time.

    Args:
        start_t: where it begins, Unix seconds.
        end_t: where it ends, Unix seconds.
        speed: incident seconds per second.
        wall_s: the wall time now (s, from any epoch).

    Attributes:
        start_t: first moment that can be shown.
        end_t: last one.
        speed: incident seconds per second.
        paused: time stands still.
    """

    def __init__(self, start_t: float, end_t: float, speed: float, wall_s: float) -> None:
        self.start_t = start_t
        self.end_t = max(start_t, end_t)
        self.speed = speed
        self.paused = False
        self._t = start_t
        self._wall_s = wall_s

    def now(self, wall_s: float) -> float:
        """Incident time at a wall time, never beyond the end."""
        if self.paused:
            return self._t
        return min(self.end_t, self._t + self.speed * max(0.0, wall_s - self._wall_s))

    def ended(self, wall_s: float) -> bool:
        """The end has been reached."""
        return self.now(wall_s) >= self.end_t

    def seek(self, t: float, wall_s: float) -> None:
        """Go to a moment; outside the replay, to its nearest end."""
        self._t, self._wall_s = min(max(t, self.start_t), self.end_t), wall_s

    def go(self, speed: float, wall_s: float) -> None:
        """Change the speed."""
        self.seek(self.now(wall_s), wall_s)
        self.speed = speed

    def pause(self, paused: bool, wall_s: float) -> None:
        """Stand still, or go on."""
        self.seek(self.now(wall_s), wall_s)
        self.paused = paused
