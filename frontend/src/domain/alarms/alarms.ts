/** Alarms stand until a person has acknowledged them and they are cleared; silence is neither. */
import type { FrameAlarm } from "../types";

export interface StandingAlarm {
  readonly alarm: FrameAlarm;
  readonly acknowledged: boolean;
  readonly cleared: boolean;
}

export type StandingAlarms = ReadonlyMap<string, StandingAlarm>;

/** What tells one alarm from another: whose it is and which. */
export function alarmKey(alarm: Pick<FrameAlarm, "node" | "alarm">): string {
  return `${alarm.node} ${alarm.alarm}`;
}

/**
 * The alarms that stand, as the server lists them: also one that its unit has cleared by itself
 * before any person had acknowledged it.
 */
export function standingAlarms(listed: readonly FrameAlarm[]): StandingAlarms {
  return new Map(
    listed.map((alarm) => [
      alarmKey(alarm),
      { alarm, acknowledged: alarm.state === "acknowledged", cleared: alarm.state === "cleared" },
    ]),
  );
}

/** The alarms that stand after a person's word on one of them has reached the log. */
export function answered(
  before: StandingAlarms,
  alarm: FrameAlarm,
  state: FrameAlarm["state"],
): StandingAlarms {
  const after = new Map(before);
  const known = after.get(alarmKey(alarm));
  if (known === undefined) return before;
  const acknowledged = known.acknowledged || state === "acknowledged";
  const cleared = known.cleared || state === "cleared";
  if (acknowledged && cleared) after.delete(alarmKey(alarm));
  else after.set(alarmKey(alarm), { ...known, acknowledged, cleared });
  return after;
}

const URGENCY: Record<FrameAlarm["alarm"], number> = { mayday: 0, evacuate: 1, pass: 2, help: 3 };

/** Whether a responder calls for help by it; `evacuate` is an order to it. */
export function isCall(alarm: FrameAlarm["alarm"]): boolean {
  return alarm !== "evacuate";
}

/** Most urgent first: not acknowledged before acknowledged, then by kind, then the oldest. */
export function byUrgency(a: StandingAlarm, b: StandingAlarm): number {
  return (
    Number(a.acknowledged) - Number(b.acknowledged) ||
    URGENCY[a.alarm.alarm] - URGENCY[b.alarm.alarm] ||
    a.alarm.t - b.alarm.t
  );
}

export function inOrder(standing: StandingAlarms): StandingAlarm[] {
  return [...standing.values()].sort(byUrgency);
}

/** The most urgent alarm of each node that is in one. */
export function alarmByNode(alarms: Iterable<FrameAlarm>): Map<string, FrameAlarm> {
  const byNode = new Map<string, FrameAlarm>();
  for (const alarm of alarms) {
    if (alarm.state === "cleared") continue;
    const known = byNode.get(alarm.node);
    if (known === undefined || URGENCY[alarm.alarm] < URGENCY[known.alarm]) byNode.set(alarm.node, alarm);
  }
  return byNode;
}
