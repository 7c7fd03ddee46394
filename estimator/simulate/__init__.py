"""Scenarios: true paths and the readings of them, the same for the same seed.

A new scenario is one new file here with `NAME` and `build(seed)`.
"""

import importlib
import pkgutil
from types import ModuleType

from estimator.simulate.base import Report, Scenario, Storey, TrueTrack

__all__ = ["Report", "Scenario", "Storey", "TrueTrack", "scenario", "scenario_names"]


def scenario_names() -> list[str]:
    """The names that `scenario` takes."""
    return sorted(_modules())


def scenario(name: str, seed: int = 0) -> Scenario:
    """Build a scenario.

    Args:
        name: one of `scenario_names()`.
        seed: equal seeds give equal scenarios.

    Raises:
        KeyError: there is no scenario of that name; the message lists those there are.
    """
    modules = _modules()
    if name not in modules:
        raise KeyError(f"no scenario {name!r}; there are {', '.join(sorted(modules))}")
    built: Scenario = modules[name].build(seed)
    return built


def _modules() -> dict[str, ModuleType]:
    """The scenario files, by the name that they give themselves."""
    found = [importlib.import_module(f"{__name__}.{info.name}") for info in pkgutil.iter_modules(__path__)]
    return {module.NAME: module for module in found if hasattr(module, "NAME")}
