/** Alarms of the past, out of the lines of the log: what was raised, when. */
import type { FrameAlarm } from "./types";

/** Units repeat an alarm while it sounds: a raise so soon after the last one is the same alarm (s). */
const REPEAT_S = 30;

/** An alarm reading, and its place in the log. */
export interface LoggedAlarm extends FrameAlarm {
  readonly seq: number;
}

interface LogLine {
  readonly seq: number;
  readonly rejected?: readonly { index?: number | null }[];
  readonly readings: readonly Record<string, unknown>[];
}

/** The alarm readings of a line of the log, those set aside excepted. */
export function alarmsInLine(line: string): LoggedAlarm[] {
  // Hardly any line has one: most need not be understood.
  if (!line.includes('"alarm"')) return [];
  const { seq, rejected, readings } = JSON.parse(line) as LogLine;
  const aside = new Set(rejected?.map(({ index }) => index));
  return readings
    .filter((reading, index) => reading.kind === "alarm" && !aside.has(index))
    .map((reading) => ({ ...(reading as unknown as FrameAlarm), seq }));
}

/** Of everything said of alarms, in whatever order it was read: the alarms, as they were raised. */
export function raisedOf(said: readonly LoggedAlarm[]): FrameAlarm[] {
  const raised: FrameAlarm[] = [];
  const known = new Map<string, { state: FrameAlarm["state"]; calledT: number }>();
  for (const { seq: _, ...one } of [...said].sort((a, b) => a.seq - b.seq)) {
    const key = `${one.node} ${one.alarm}`;
    const before = known.get(key);
    if (one.state !== "raised") {
      known.set(key, { state: one.state, calledT: before?.calledT ?? Number.NEGATIVE_INFINITY });
      continue;
    }
    const again = before !== undefined && one.t <= before.calledT;
    const sounding = before !== undefined && one.t - before.calledT <= REPEAT_S;
    const same = before?.state === "raised" || (before?.state === "acknowledged" && sounding);
    if (again) continue;
    if (!same) raised.push(one);
    known.set(key, { state: same ? (before?.state ?? "raised") : "raised", calledT: one.t });
  }
  return raised;
}
