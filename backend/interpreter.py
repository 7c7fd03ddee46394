"""How the interpreter is set for a process that stays: the web process and the estimator worker."""

import gc

YOUNG_OBJECTS = 50_000
"""A batch of a thousand readings is some thousands of objects: Python's own 700 looks at each repeatedly."""


def tune_for_serving() -> None:
    """Set the collector once all modules are loaded and the application stands.

    What has been made so far is never collected, so that the collector need not look at it: with FastAPI's
    routes and models it took a third of the time of a small batch, and the compiler's objects, which lie in
    the worker, let the tracker wait for a tenth of a second every few hundred keyframes.
    """
    gc.collect()
    gc.freeze()
    gc.set_threshold(YOUNG_OBJECTS, 20, 20)
