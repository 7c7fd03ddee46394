/** The one bar for live and replay: its ends, its speeds, its marks. */
import type { FrameAlarm, Incident, Track } from "../types";
import { alarmWord } from "../words";

export interface Extent {
  readonly from: number;
  readonly to: number;
}

export interface Mark {
  readonly t: number;
  readonly kind: "alarm" | "drop" | "set";
  readonly text: string;
}

export const SPEEDS = [0.5, 1, 2, 4, 8, 16, 32] as const;

/** The next faster (+1) or slower (-1) speed. */
export function nextSpeed(speed: number, step: 1 | -1): number {
  const index = SPEEDS.findIndex((known) => known >= speed);
  const at = index === -1 ? SPEEDS.length - 1 : index;
  return SPEEDS[Math.min(SPEEDS.length - 1, Math.max(0, at + step))] ?? 1;
}

export function within(extent: Extent, t: number): number {
  return Math.min(extent.to, Math.max(extent.from, t));
}

/** What the bar spans: from the first thing known to now; never less than a second. */
export function extentOf(
  incident: Incident | null,
  tracks: readonly Track[],
  earliestT: number,
  newestT: number,
): Extent {
  const sinceT = incident?.earliest_t ?? Number.NEGATIVE_INFINITY;
  const known = [incident?.first_t, earliestT, ...tracks.map(({ points }) => points[0]?.[0])];
  let from = Math.min(...known.filter((t) => t != null && t >= sinceT).map(Number));
  if (!Number.isFinite(from)) from = incident?.clock === "live" ? incident.created : newestT;
  return { from: Math.min(from, newestT - 1), to: newestT };
}

/** What the handle can be put to lies so far apart (s). */
export const HANDLE_STEP_S = 0.5;

/** Where the bar begins so that its end is a whole number of steps away: a handle stands on steps only, counted
 * from there, and would not reach the end of an incident that has just begun. */
export function handleFrom({ from, to }: Extent): number {
  return to - Math.ceil((to - from) / HANDLE_STEP_S) * HANDLE_STEP_S;
}

/** What a live picture and the log say of one drop may differ by this (s). */
const SAME_DROP_S = 10;

/** Adds the breadcrumbs dropped that are not marked yet; the very same array where nothing is new. */
export function withDropMarks(
  marks: readonly Mark[],
  drops: readonly { node: string; t: number }[],
  name: (node: string) => string,
): readonly Mark[] {
  const fresh = drops
    .map(({ node, t }): Mark => ({ t, kind: "drop", text: `${name(node)} dropped` }))
    .filter(
      (mark) => !marks.some((known) => known.text === mark.text && Math.abs(known.t - mark.t) < SAME_DROP_S),
    );
  return fresh.length === 0 ? marks : [...marks, ...fresh].sort((a, b) => a.t - b.t);
}

/** Adds the raised alarms not marked yet; the very same array where nothing is new. */
export function withAlarmMarks(
  marks: readonly Mark[],
  alarms: readonly FrameAlarm[],
  name: (node: string) => string,
): readonly Mark[] {
  const fresh = alarms
    .filter(({ state }) => state !== "cleared")
    .map(
      (alarm): Mark => ({ t: alarm.t, kind: "alarm", text: `${alarmWord(alarm.alarm)} ${name(alarm.node)}` }),
    )
    .filter((mark) => !marks.some((known) => known.t === mark.t && known.text === mark.text));
  return fresh.length === 0 ? marks : [...marks, ...fresh].sort((a, b) => a.t - b.t);
}

/** Adds the marks of what was set that are not there yet; the very same array where nothing is new. */
export function withSetMarks(marks: readonly Mark[], set: readonly Mark[]): readonly Mark[] {
  const fresh = set.filter((mark) => !marks.some(({ t, text }) => t === mark.t && text === mark.text));
  return fresh.length === 0 ? marks : [...marks, ...fresh].sort((a, b) => a.t - b.t);
}

/** What happened at the moment that is shown: the texts of the marks within a second of it. */
export function eventsAt(marks: readonly Mark[], t: number): readonly Mark[] {
  return marks.filter((mark) => Math.abs(mark.t - t) <= 1);
}

/** The nearest mark after (+1) or before (-1) `t`; null where there is none. */
export function neighbourMark(marks: readonly Mark[], t: number, step: 1 | -1): Mark | null {
  const beyond = marks.filter((mark) => (mark.t - t) * step > 0.5);
  beyond.sort((a, b) => Math.abs(a.t - t) - Math.abs(b.t - t));
  return beyond[0] ?? null;
}
