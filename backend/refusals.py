"""How a command refuses: one line that says why."""

from collections.abc import Iterator
from contextlib import contextmanager
from typing import NoReturn

import typer

from backend.errors import CommandRefused, Problem


def refuse(reason: object) -> NoReturn:
    """End with a line that says why."""
    typer.echo(f"firethread: {reason}", err=True)
    raise typer.Exit(2)


@contextmanager
def refusing() -> Iterator[None]:
    """What the caller can mend ends in one line; a defect of ours keeps its traceback."""
    try:
        yield
    except BrokenPipeError:
        raise typer.Exit(1) from None  # whoever read our output has had enough
    except (CommandRefused, Problem) as error:
        refuse(error)
