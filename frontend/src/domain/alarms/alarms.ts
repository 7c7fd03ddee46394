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

/** The alarms that stand after a person's word on one of them has reached the log; of a later call it says nothing. */
export function answered(
  before: StandingAlarms,
  alarm: FrameAlarm,
  state: FrameAlarm["state"],
): StandingAlarms {
  const after = new Map(before);
  const known = after.get(alarmKey(alarm));
  if (known === undefined || known.alarm.t !== alarm.t) return before;
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

/** Who calls, and by what: a unit that lies still and a voice on the radio are one person in trouble. */
export interface Caller {
  readonly node: string;
  /** The gravest first. */
  readonly calls: readonly [StandingAlarm, ...StandingAlarm[]];
  /** A person has answered all of them. */
  readonly acknowledged: boolean;
}

/** Each caller once, in the order of what is most urgent of each; `list`: most urgent first. */
export function callers(list: readonly StandingAlarm[]): Caller[] {
  const byNode = new Map<string, [StandingAlarm, ...StandingAlarm[]]>();
  for (const one of list) {
    const known = byNode.get(one.alarm.node);
    if (known === undefined) byNode.set(one.alarm.node, [one]);
    else known.push(one);
  }
  return [...byNode].map(([node, calls]) => ({
    node,
    calls: calls.sort((a, b) => URGENCY[a.alarm.alarm] - URGENCY[b.alarm.alarm]),
    acknowledged: calls.every(({ acknowledged }) => acknowledged),
  }));
}

/** What tells whether there is another call, or another answer, under the button that answers a caller. */
export function callerKey({ calls }: Caller): string {
  return calls.map(({ alarm, acknowledged }) => `${alarmKey(alarm)} ${acknowledged}`).join();
}

/** Those of a caller's calls that a person's next word answers: the unanswered ones, or, where there are none, all. */
export function answerable({ calls, acknowledged }: Caller): readonly StandingAlarm[] {
  return acknowledged ? calls : calls.filter((one) => !one.acknowledged);
}

/** What somebody says who calls; what a second call of his says, after its name. `word`: how a kind is called. */
export function saidBy(
  { calls }: Pick<Caller, "calls">,
  word: (kind: FrameAlarm["alarm"]) => string,
): string {
  return calls
    .flatMap(({ alarm }, at) =>
      alarm.text ? [at === 0 ? alarm.text : `${word(alarm.alarm)}: ${alarm.text}`] : [],
    )
    .join(" · ");
}

/** A caller's line with its name, and a line of what is said, each with its edges (CSS pixels, text of usual size). */
const NAME_PX = 68;
const NAME_IN_TWO_PX = 92;
const LINE_PX = 24;

/**
 * In how many lines each of several callers says what is said, so that all of them are seen with their buttons.
 *
 * `room_px`: for all of them; `narrow`: a name takes two lines; `text`: how many times its usual size text has.
 */
export function linesEach(callers: number, room_px: number, narrow: boolean, text = 1): number {
  const name_px = (narrow ? NAME_IN_TWO_PX : NAME_PX) * text;
  return Math.max(1, Math.floor((room_px / callers - name_px) / (LINE_PX * text)));
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
