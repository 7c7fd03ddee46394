"""How a process says what happens in it: lines on standard error, standard output being the contract's."""

import sys

import structlog


def to_standard_error() -> None:
    """Send structlog's lines to standard error, tracebacks as Python writes them.

    The library's own choice is standard output, and tracebacks with the source around every frame and all its
    variables: these take seconds, in which an event loop would answer nobody.
    """
    colours = sys.stderr.isatty()
    renderer = structlog.dev.ConsoleRenderer(
        colors=colours, exception_formatter=structlog.dev.plain_traceback
    )
    structlog.configure(
        processors=[
            structlog.contextvars.merge_contextvars,
            structlog.processors.add_log_level,
            structlog.processors.TimeStamper(fmt="iso", utc=True),
            renderer,
        ],
        logger_factory=structlog.PrintLoggerFactory(sys.stderr),
    )
