/** Alarms stand until a person has acknowledged and cleared them; silence is neither. */
import type { FrameAlarm } from "./types";

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
 * The alarms that stand after the server's list has changed.
 *
 * One that a unit clears by itself before any person has acknowledged it stands on, as cleared; one
 * that was acknowledged and is then cleared, or no longer listed, is over. An alarm raised anew
 * (a later `t` in state raised) begins again.
 */
export function standingAlarms(before: StandingAlarms, listed: readonly FrameAlarm[]): StandingAlarms {
  const after = new Map<string, StandingAlarm>();
  const present = new Map(listed.map((alarm) => [alarmKey(alarm), alarm]));
  for (const [key, alarm] of present) {
    const known = before.get(key);
    const raisedAnew = alarm.state === "raised";
    const acknowledged = alarm.state === "acknowledged" || (!raisedAnew && (known?.acknowledged ?? false));
    const cleared = alarm.state === "cleared";
    // Cleared before this screen ever saw it raised: nothing to show.
    if (cleared && (known === undefined || acknowledged)) continue;
    after.set(key, { alarm, acknowledged, cleared });
  }
  for (const [key, known] of before) {
    if (!present.has(key) && !known.acknowledged) after.set(key, { ...known, cleared: true });
  }
  return after;
}

/** The alarms that stand after a person's word on one of them has reached the log. */
export function answered(
  before: StandingAlarms,
  alarm: FrameAlarm,
  states: readonly FrameAlarm["state"][],
): StandingAlarms {
  const after = new Map(before);
  const known = after.get(alarmKey(alarm));
  if (known === undefined) return before;
  const acknowledged = known.acknowledged || states.includes("acknowledged");
  const cleared = known.cleared || states.includes("cleared");
  if (acknowledged && cleared) after.delete(alarmKey(alarm));
  else after.set(alarmKey(alarm), { ...known, acknowledged, cleared });
  return after;
}

/** The reading states to post when a person acknowledges: a unit's own clearing is confirmed at once. */
export function statesToAcknowledge(standing: StandingAlarm): FrameAlarm["state"][] {
  return standing.cleared ? ["acknowledged", "cleared"] : ["acknowledged"];
}

const URGENCY: Record<FrameAlarm["alarm"], number> = { mayday: 0, evacuate: 1, pass: 2, help: 3 };

/** Most urgent first: not acknowledged before acknowledged, then by kind, then the oldest. */
export function inOrder(standing: StandingAlarms): StandingAlarm[] {
  return [...standing.values()].sort(
    (a, b) =>
      Number(a.acknowledged) - Number(b.acknowledged) ||
      URGENCY[a.alarm.alarm] - URGENCY[b.alarm.alarm] ||
      a.alarm.t - b.alarm.t,
  );
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
