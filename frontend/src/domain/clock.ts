/** Incident time between two messages: the last word of the server, carried on by the local clock. */

export interface IncidentClock {
  /** Incident time at the last word (Unix s). */
  readonly t: number;
  /** Local monotonic clock then (ms). */
  readonly localMs: number;
  /** Incident seconds per local second: 1 live, the speed in a replay, 0 while it stands still. */
  readonly rate: number;
  /** Incident time never passes this (end of a replay). */
  readonly limitT?: number | undefined;
}

/** Incident time at local time `localMs` (Unix s). */
export function incidentTime(clock: IncidentClock, localMs: number): number {
  const t = clock.t + (clock.rate * Math.max(0, localMs - clock.localMs)) / 1000;
  return clock.limitT === undefined ? t : Math.min(t, Math.max(clock.limitT, clock.t));
}
