"""How a picture looks at a moment: status from age, uncertainty that grows, storey. A pure function.

Nothing here depends on the estimator being alive: the web process presents the newest record anew every
second, so that a fix ages on the screen whatever has happened to the process that made it.
"""

from collections.abc import Iterator, Sequence

from backend.live.frame import (
    AirState,
    Frame,
    FrameAlarm,
    FrameAside,
    FrameClock,
    FrameNode,
    FrameNotice,
    Status,
)
from backend.live.record import PictureRecord, RecordNode, RecordNotice
from backend.log.incident import Incident, IncidentSettings
from estimator.estimate import Covariance6
from estimator.levels import most_probable
from estimator.measurements.node import MOVING_ROLES, Role

HORIZONTAL_GROWTH_MPS = 0.5
"""Standard deviation per second of age that a moving node gains: a walk, in no known direction."""

VERTICAL_GROWTH_MPS = 0.1
"""The same upwards: stairs are taken now and then."""

GROWS_AFTER_S = 1.0
"""A fix of the last second is as good as new: units report once or several times a second."""

MOVED_SHOWN_S = 600.0
NOTICES_SHOWN = 8

WHY_NOWHERE = {"too_late", "no_origin"}
"""Codes of notices that tell why nothing that somebody reports places him, who may have no line either."""

Floors = Sequence[tuple[int, str, float]]
"""Number, spoken name and height of the floor (m) of each storey."""


def status_of(role: Role, age_s: float, settings: IncidentSettings, *, retired: bool) -> Status:
    """The status of a node.

    Args:
        role: what it is.
        age_s: since its newest fused reading (s).
        settings: of the incident: after what age a node is stale, lost.
        retired: it has left.
    """
    if retired:
        return "retired"
    if role == "base":
        return "live"
    if role in MOVING_ROLES:
        stale_after_s, lost_after_s = settings.stale_after_s, settings.lost_after_s
    else:
        stale_after_s, lost_after_s = settings.static_stale_after_s, settings.static_lost_after_s
    if age_s > lost_after_s:
        return "lost"
    return "stale" if age_s > stale_after_s else "live"


def grown(covariance_m2: Covariance6, role: Role, age_s: float) -> Covariance6:
    """The covariance of a position after a time without news.

    Args:
        covariance_m2: upper triangle (m²) when the news was new.
        role: what the node is; only moving ones grow uncertain.
        age_s: since then (s).
    """
    if age_s <= GROWS_AFTER_S or role not in MOVING_ROLES:
        return covariance_m2
    ee, en, eu, nn, nu, uu = covariance_m2
    horizontal = (HORIZONTAL_GROWTH_MPS * age_s) ** 2
    vertical = (VERTICAL_GROWTH_MPS * age_s) ** 2
    return ee + horizontal, en, eu, nn + horizontal, nu, uu + vertical


def age_s(known: RecordNode, t: float) -> float:
    """How old a node's newest reading is at a moment (s).

    Nothing is newer than when it came: what is of the future then is by a clock that was put back since, and
    how old it is nobody knows. It is not called new.

    Args:
        known: the node.
        t: the moment, Unix seconds.
    """
    return abs(t - known.t)


def covariance_at(known: RecordNode, t: float) -> Covariance6 | None:
    """The covariance of a node's position as it is shown at a moment (m²).

    Args:
        known: the node.
        t: the moment, Unix seconds.
    """
    if known.covariance_m2 is None or known.retired:
        return known.covariance_m2
    return grown(known.covariance_m2, known.role, age_s(known, t))


def turn_back_bar(known: RecordNode, settings: IncidentSettings) -> float | None:
    """The pressure at which half of the air above the low pressure is used (bar); None: none was reported.

    As much is left for the way out as the way in has taken, before the low-air alarm.
    """
    if known.air_first_bar is None:
        return None
    return max(settings.low_air_bar, (known.air_first_bar + settings.low_air_bar) / 2.0)


def air_state(known: RecordNode, settings: IncidentSettings) -> AirState | None:
    """Whether a responder's air is low, or so far used that it is time to turn back.

    The lowest report of the cylinder counts, so that none that wavers comes and goes (decision 0063).
    """
    least_bar, back_bar = known.air_least_bar, turn_back_bar(known, settings)
    if least_bar is None or back_bar is None or known.retired:
        return None
    if least_bar <= settings.low_air_bar:
        return "low"
    return "turn_back" if least_bar <= back_bar else None


def floors_of(incident: Incident) -> Floors:
    """The storeys of an incident."""
    return [(level.level, level.name, level.up_m) for level in incident.levels]


def present_node(known: RecordNode, now: float, settings: IncidentSettings, floors: Floors) -> FrameNode:
    """One node as it is shown at a moment; see `present`."""
    covariance_m2 = covariance_at(known, now)
    storey = None
    if floors and known.position_m is not None and covariance_m2 is not None:
        storey = most_probable(floors, known.position_m[2], covariance_m2[5])
    return FrameNode(
        node=known.node,
        role=known.role,
        callsign=known.callsign,
        crew=known.crew,
        position_m=known.position_m,
        covariance_m2=covariance_m2,
        heading_rad=known.heading_rad,
        heading_sigma_rad=known.heading_sigma_rad,
        speed_mps=known.speed_mps,
        level=None if storey is None else storey.level,
        level_p=None if storey is None else storey.probability,
        t=known.t,
        status=status_of(known.role, age_s(known, now), settings, retired=known.retired),
        battery=known.battery,
        air_bar=known.air_bar,
        temperature_c=known.temperature_c,
        motionless_s=known.motionless_s,
        moved=known.moved_t is not None and now - known.moved_t < MOVED_SHOWN_S,
        retire_reason=known.retire_reason,
        battery_t=known.battery_t,
        air_t=known.air_t,
        temperature_t=known.temperature_t,
        motionless_t=known.motionless_t,
        air_state=air_state(known, settings),
        air_turn_back_bar=turn_back_bar(known, settings),
    )


def present(record: PictureRecord, seq: int, now: float, incident: Incident) -> Frame:
    """The frame that shows a record at a moment.

    Positions stay at the last fix; only what is said about their age and uncertainty depends on `now`.

    Args:
        record: what is known.
        seq: the newest log entry in it.
        now: the moment, Unix seconds.
        incident: its settings and levels.
    """
    floors = floors_of(incident)
    return Frame(
        incident=incident.id,
        seq=seq,
        t=now,
        clock_t=now,
        newest_t=record.t,
        nodes=tuple(present_node(known, now, incident.settings, floors) for known in record.nodes),
        alarms=tuple(
            FrameAlarm(node=alarm.node, alarm=alarm.alarm, state=alarm.state, t=alarm.t, text=alarm.text)
            for alarm in record.alarms
        ),
        notices=tuple(
            FrameNotice(code=notice.code, t=notice.t, text=notice.text, node=notice.node)
            for notice in _notices_shown(record)
        ),
        set_aside=tuple(_set_aside_at(record, now, incident.settings)),
        clocks=tuple(
            FrameClock(gateway=clock.gateway, behind_s=clock.behind_s, clock_of=clock.clock_of)
            for clock in record.clocks
            if 0.0 <= now - clock.t <= incident.settings.lost_after_s
        ),
    )


def _notices_shown(record: PictureRecord) -> list[RecordNotice]:
    """The newest notices, and however old the one that says why somebody has no position."""
    placed = {known.node for known in record.nodes if known.position_m is not None}
    first = len(record.notices) - NOTICES_SHOWN
    return [
        notice
        for at, notice in enumerate(record.notices)
        if at >= first or (notice.code in WHY_NOWHERE and notice.node not in placed)
    ]


def _set_aside_at(record: PictureRecord, now: float, settings: IncidentSettings) -> Iterator[FrameAside]:
    """Whose readings have been set aside by a moment, but for those who are live on the map all the same."""
    nodes = {known.node: known for known in record.nodes}
    for aside in record.set_aside:
        if aside.since_t > now:
            continue
        known = nodes.get(aside.name)
        if known is not None:
            status = status_of(known.role, age_s(known, now), settings, retired=known.retired)
            if status == "retired" or (status == "live" and known.position_m is not None):
                continue
        yield FrameAside(
            name=aside.name,
            callsign=aside.callsign or (None if known is None else known.callsign),
            crew=aside.crew or (None if known is None else known.crew),
            gateway=aside.gateway,
            t=min(aside.t, now),
            code=aside.code,
            text=aside.text,
        )


def now_of(incident: Incident, record: PictureRecord, server_t: float) -> float:
    """The moment that is now for an incident.

    Args:
        incident: its clock.
        record: its newest picture.
        server_t: the server's clock, Unix seconds.

    Returns:
        The server's clock for `live` incidents (of a closed one, at most when it was closed); the newest
        reading for `recorded` ones, 0 before the first.
    """
    if incident.clock == "live":
        return server_t if incident.closed is None else min(server_t, incident.closed)
    return 0.0 if record.t is None else record.t
