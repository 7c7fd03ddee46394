"""Plays a scenario through the public API, as its gateways would, again and again as new incidents."""

import asyncio
import contextlib
import signal
import time

import structlog

from backend.demo.batching import batches_of, body_of, gateways_of
from backend.demo.client import Client, IncidentGone, Refused
from backend.demo.pace import Pace
from backend.errors import CommandRefused
from estimator.simulate import Scenario, scenario, scenario_names

log = structlog.get_logger(__name__)

NAME_SUFFIX = " (demo)"
"""Tells our incidents from real ones: those that an earlier run left open are closed by the next."""
LEFT_AFTER_S = 5.0
"""A gateway of ours posts more often: where nothing comes for so long, nobody plays any more."""
GOODBYE_S = 1.0
BETWEEN_S = 5.0


async def play(
    url: str, token: str | None, scenario_name: str, seed: int, speed: float = 1.0, once: bool = False
) -> None:
    """Wait for the server, then play a scenario in an incident of its own; when it ends, begin again.

    Args:
        url: of the server.
        token: its access token; None where it is open.
        scenario_name: one of `estimator.simulate.scenario_names()`.
        seed: of the first round; each further round takes the next one.
        speed: 1 plays on the live clock; anything else in an incident of clock `recorded`.
        once: one round only.

    Raises:
        CommandRefused: there is no such scenario, or `speed` is not above 0.
        Refused: the server does not take what we send (a missing token, for one).
    """
    if not speed > 0.0:
        raise CommandRefused(f"--speed must be above 0, not {speed}")
    if scenario_name not in scenario_names():
        raise CommandRefused(f"--scenario is one of {', '.join(scenario_names())}, not {scenario_name!r}")
    played = scenario(scenario_name, seed)
    client = Client(url, token)
    try:
        await client.wait_until_ready()
        await _close_what_was_left(client, played.incident + NAME_SUFFIX)
        while True:
            await _play_once(client, played, speed)
            if once:
                return
            seed += 1
            played = await asyncio.to_thread(scenario, scenario_name, seed)
            await asyncio.sleep(BETWEEN_S)
    finally:
        await client.close()


def play_until_stopped(
    url: str, token: str | None, scenario_name: str, seed: int, speed: float = 1.0, once: bool = False
) -> None:
    """`play` in a process of its own: SIGTERM and SIGINT end it, and close its incident."""

    async def main() -> None:
        task = asyncio.current_task()
        loop = asyncio.get_running_loop()
        if task is not None:
            for number in (signal.SIGTERM, signal.SIGINT):
                loop.add_signal_handler(number, task.cancel)
        with contextlib.suppress(asyncio.CancelledError):
            await play(url, token, scenario_name, seed, speed, once)

    asyncio.run(main())


async def _close_what_was_left(client: Client, name: str) -> None:
    """Close open incidents of a name in which nobody plays: a run that was killed cannot close its own."""
    before = {one["id"]: one["last_seq"] for one in await client.active_incidents() if one["name"] == name}
    if not before:
        return
    log.info("open incidents of the same name: looking whether somebody plays", incidents=list(before))
    await asyncio.sleep(LEFT_AFTER_S)
    for one in await client.active_incidents():
        if one["id"] not in before:
            continue
        if one["last_seq"] > before[one["id"]]:
            log.warning("somebody else plays this incident; it goes on", incident=one["id"])
        else:
            log.warning("an earlier run left this incident open; it is closed", incident=one["id"])
            await client.close_incident(one["id"])


async def _play_once(client: Client, played: Scenario, speed: float) -> None:
    """One incident, from its first reading to its closing."""
    # Stopped in the middle of it, we would not know what to close: creating goes on when we are cancelled.
    creating = asyncio.create_task(
        client.create_incident(
            {
                "name": played.incident + NAME_SUFFIX,
                "clock": "live" if speed == 1.0 else "recorded",
                "levels": [{"level": s.level, "name": s.name, "up_m": s.up_m} for s in played.storeys],
            }
        )
    )
    try:
        incident = await asyncio.shield(creating)
        log.info("incident begins", incident=incident, scenario=played.name, minutes=played.duration_s / 60)
        await _post_all(client, incident, played, speed)
    except asyncio.CancelledError:
        # Nobody else would ever end what we began; but a server that is gone itself is not waited for.
        with contextlib.suppress(TimeoutError, Refused):
            async with asyncio.timeout(GOODBYE_S):
                await client.close_incident(await creating)
        raise
    await client.close_incident(incident)
    log.info("incident ended", incident=incident)


async def _post_all(client: Client, incident: str, played: Scenario, speed: float) -> None:
    """All gateways side by side, until they are done or the incident is taken away."""
    names = gateways_of(played.reports)
    start, pace = time.time(), Pace(speed, names)
    try:
        async with asyncio.TaskGroup() as gateways:
            for gateway in names:
                gateways.create_task(_play_gateway(client, incident, played, gateway, start, pace))
    except* IncidentGone as gone:
        log.info("incident taken away", incident=incident, why=str(gone.exceptions[0]))


async def _play_gateway(
    client: Client, incident: str, played: Scenario, gateway: str, start: float, pace: Pace
) -> None:
    """What one gateway posts, each batch when it is due; what a lost link holds up follows in order."""
    for number, batch in enumerate(batches_of(played.reports, gateway)):
        await pace.wait(gateway, batch.due_s)
        await client.post(incident, body_of(batch, gateway, f"{gateway}-{number:06d}", start))
    await pace.done(gateway)
