/** Incident time between two messages: the last word of the server, carried on by the local clock. */

export interface IncidentClock {
  /** Incident time at the last word (Unix s). */
  readonly t: number;
  /** Local monotonic clock then (ms). */
  readonly localMs: number;
  /** Incident seconds per local second: 1 live, the speed in a replay, 0 while it stands still. */
  readonly rate: number;
  /** When a word last came that was not late, on the same clock (ms); none: the last one was not. */
  readonly inTimeMs?: number;
  /** Incident time never passes this (end of a replay). */
  readonly limitT?: number | undefined;
}

/** Where everything has been late for so long, the server's clock has been set back (ms). */
export const BELIEVED_AFTER_MS = 60_000;

/**
 * The clock after the server has said that it is `t` now. A message long under way says what was true when it was
 * sent: it does not set the clock back, or every age would shrink by as much.
 */
export function heard(clock: IncidentClock, t: number, localMs: number, rate: number): IncidentClock {
  const goneOn = incidentTime(clock, localMs);
  const inTimeMs = clock.inTimeMs ?? clock.localMs;
  const late = clock.rate > 0 && rate > 0 && goneOn > t && localMs - inTimeMs < BELIEVED_AFTER_MS;
  return late ? { t: goneOn, localMs, rate, inTimeMs } : { t, localMs, rate };
}

/** Incident time at local time `localMs` (Unix s). */
export function incidentTime(clock: IncidentClock, localMs: number): number {
  const t = clock.t + (clock.rate * Math.max(0, localMs - clock.localMs)) / 1000;
  return clock.limitT === undefined ? t : Math.min(t, Math.max(clock.limitT, clock.t));
}
