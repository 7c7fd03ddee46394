"""How a command refuses: one line that says why."""

from collections.abc import Iterator
from contextlib import contextmanager
from typing import NoReturn

import typer


def refuse(reason: object) -> NoReturn:
    """End with a line that says why."""
    typer.echo(f"firethread: {reason}", err=True)
    raise typer.Exit(2)


@contextmanager
def refusing(*more: type[Exception]) -> Iterator[None]:
    """What the caller can mend ends in one line; a defect of ours keeps its traceback."""
    from backend.errors import Problem
    from backend.log.migrate import SchemaTooNew
    from backend.recordings import NotTheDataSet

    try:
        yield
    except BrokenPipeError:
        raise typer.Exit(1) from None  # whoever read our output has had enough
    except (Problem, SchemaTooNew, NotTheDataSet, OSError, ValueError) as error:
        refuse(error)
    except more as error:
        refuse(error)
    except KeyError as error:
        refuse(error.args[0])
