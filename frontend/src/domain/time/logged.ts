/** What the lines of the log say that the timeline marks: alarms, and breadcrumbs that are dropped. */
import type { FrameAlarm, FrameNode, Incident } from "../types";

/** An alarm reading, and its place in the log. */
export interface LoggedAlarm extends FrameAlarm {
  readonly seq: number;
}

/** A breadcrumb that somebody dropped, or that was only introduced. */
export interface LoggedDrop {
  readonly node: string;
  readonly t: number;
  readonly dropped: boolean;
}

export interface Logged {
  readonly alarms: readonly LoggedAlarm[];
  readonly drops: readonly LoggedDrop[];
}

interface LogLine {
  readonly seq: number;
  readonly received: number;
  readonly sent?: number | null;
  readonly rejected?: readonly { index?: number | null }[];
  readonly readings: readonly Record<string, unknown>[];
}

/** The kinds of readings that tell of events: lines without any need not come. */
export const EVENTS = ["alarm", "drop", "node"] as const;

/**
 * What a line says, readings that were set aside excepted; an alarm from a clock that is ahead, as the server has it
 * (`backend/tracking/fold.py`), as of when it came.
 */
export function loggedIn(line: string, clock: Incident["clock"]): Logged {
  const { seq, received, sent, rejected, readings } = JSON.parse(line) as LogLine;
  const cameT = (clock === "live" ? received : sent) ?? Number.POSITIVE_INFINITY;
  const aside = new Set(rejected?.map(({ index }) => index));
  const taken = readings.filter((_, index) => !aside.has(index));
  return {
    alarms: taken
      .filter(({ kind }) => kind === "alarm")
      .map((reading) => ({ ...(reading as unknown as FrameAlarm), seq }))
      .map((alarm) => ({ ...alarm, t: Math.min(alarm.t, cameT) })),
    drops: taken
      .filter(({ kind, role }) => kind === "drop" || (kind === "node" && role === "breadcrumb"))
      .map((reading) => reading as unknown as { kind: string; node: string; t: number })
      .map(({ kind, node, t }) => ({ node, t, dropped: kind === "drop" })),
  };
}

/** The newest epoch that a line tells of, readings that were set aside excepted (Unix s); -∞ where there is none. */
export function newestIn(line: string): number {
  const { rejected, readings } = JSON.parse(line) as LogLine;
  const aside = new Set(rejected?.map(({ index }) => index));
  return Math.max(
    ...readings.map(({ t }, index) => (aside.has(index) ? Number.NEGATIVE_INFINITY : Number(t))),
  );
}

/** When each breadcrumb was dropped; of one that nobody is said to have dropped, when it was first introduced. */
export function dropsOf(said: readonly LoggedDrop[]): { node: string; t: number }[] {
  const dropped = new Set(said.flatMap((one) => (one.dropped ? [one.node] : [])));
  const first = new Map<string, LoggedDrop>();
  for (const one of said) {
    if (dropped.has(one.node)) continue;
    const known = first.get(one.node);
    if (known === undefined || one.t < known.t) first.set(one.node, one);
  }
  return [...said.filter((one) => one.dropped), ...first.values()].map(({ node, t }) => ({ node, t }));
}

/** The breadcrumbs among some nodes that a live picture brings, and the epochs of their newest readings. */
export function newBreadcrumbs(
  nodes: readonly FrameNode[],
  known: ReadonlySet<string>,
): { node: string; t: number }[] {
  return nodes
    .filter(({ node, role }) => role === "breadcrumb" && !known.has(node))
    .map(({ node, t }) => ({ node, t }));
}
