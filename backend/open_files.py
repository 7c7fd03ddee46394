"""How many files and connections this process may have open."""

import resource

import structlog

log = structlog.get_logger()


def raise_open_files() -> None:
    """Raise the soft limit of open files to the hard one: each screen and each gateway takes one.

    Shells give 1,024 for the sake of programs that use select(); this one does not.
    """
    soft, hard = resource.getrlimit(resource.RLIMIT_NOFILE)
    if soft == hard:
        return
    try:
        resource.setrlimit(resource.RLIMIT_NOFILE, (hard, hard))
    except (ValueError, OSError) as error:
        log.warning("the limit of open files stays as it is", limit=soft, why=str(error))
    else:
        log.info("the limit of open files is raised", before=soft, now=hard)
