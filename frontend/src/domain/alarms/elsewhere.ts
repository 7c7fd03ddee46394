/** Calls for help in incidents other than the one that is shown. */

import { toldApart } from "../people/namesakes";
import { isBehind, standsStill } from "../picture";
import { type IncidentClock, incidentTime } from "../time/clock";
import type { FrameAlarm, FrameMessage, FrameNode, Incident } from "../types";
import { alarmWord, nameOf } from "../words";
import { byUrgency, callers, inOrder, isCall, type StandingAlarm, standingAlarms } from "./alarms";

/** What a frame tells, as far as this is about it. */
export interface Shown {
  readonly seq: number;
  readonly clock_t: number;
  readonly nodes: readonly Pick<FrameNode, "node" | "callsign" | "role" | "status">[];
  readonly alarms: readonly FrameAlarm[];
  readonly notices: FrameMessage["notices"];
}

/** What a look into another incident has found. */
export interface Glimpse {
  /** The newest entry of its log that was in the picture. */
  readonly seq: number;
  /** Calls for help that stand there, the most urgent first. */
  readonly calls: readonly StandingAlarm[];
  /** Who calls: the spoken name of each node in `calls`. */
  readonly names: ReadonlyMap<string, string>;
  readonly clock: IncidentClock;
  /** A call that comes now would not be seen: the estimator there could not go on, or is behind. */
  readonly blind: boolean;
}

/** What the screen says of one other incident in which somebody calls for help. */
export interface CallElsewhere {
  readonly incident: Incident;
  /** The most urgent call there. */
  readonly call: StandingAlarm;
  readonly who: string;
  /** Who else calls there. */
  readonly more: number;
  readonly clock: IncidentClock;
}

/** @param localMs the local monotonic clock when the frame came (ms) */
export function glimpseOf(incident: Incident, frame: Shown, localMs: number): Glimpse {
  const calls = inOrder(standingAlarms(frame.alarms.filter(({ alarm }) => isCall(alarm))));
  const calling = new Set(calls.map(({ alarm }) => alarm.node));
  const apart = toldApart(frame.nodes);
  const names = frame.nodes
    .filter(({ node }) => calling.has(node))
    .map((node): [string, string] => [node.node, apart.get(node.node) ?? nameOf(node)]);
  const clock = { t: frame.clock_t, localMs, rate: incident.clock === "live" ? 1 : 0 };
  return {
    seq: frame.seq,
    calls,
    names: new Map(names),
    clock,
    blind: standsStill(frame) || isBehind(frame),
  };
}

/** The incidents to be looked into: a call is a reading, so without a new entry in the log there is none. */
export function toLookInto(
  active: readonly Incident[],
  shown: string | null,
  glimpses: ReadonlyMap<string, Glimpse>,
): Incident[] {
  return active.filter(({ id, last_seq }) => id !== shown && (glimpses.get(id)?.seq ?? 0) < last_seq);
}

/** One entry for each other incident in which somebody calls, the most urgent first. */
export function callsElsewhere(
  active: readonly Incident[],
  shown: string | null,
  glimpses: ReadonlyMap<string, Glimpse>,
): CallElsewhere[] {
  return active
    .flatMap((incident): CallElsewhere[] => {
      const glimpse = incident.id === shown ? undefined : glimpses.get(incident.id);
      const call = glimpse?.calls[0];
      if (glimpse === undefined || call === undefined) return [];
      const who = glimpse.names.get(call.alarm.node) ?? call.alarm.node;
      return [{ incident, call, who, more: callers(glimpse.calls).length - 1, clock: glimpse.clock }];
    })
    .sort((a, b) => byUrgency(a.call, b.call));
}

/** The names of the other incidents in which a call would not be seen. */
export function blindElsewhere(
  active: readonly Incident[],
  shown: string | null,
  glimpses: ReadonlyMap<string, Glimpse>,
): string[] {
  return active.filter(({ id }) => id !== shown && glimpses.get(id)?.blind).map(({ name }) => name);
}

/** How long ago it was called (s). */
export function callAgeS({ call, clock }: CallElsewhere, localMs: number): number {
  return incidentTime(clock, localMs) - call.alarm.t;
}

/** Said aloud: the calls that nobody has answered; the same words as long as nothing is new. */
export function unansweredInWords(calls: readonly CallElsewhere[]): string {
  return calls
    .filter(({ call }) => !call.acknowledged)
    .map(({ incident, call, who }) => `${alarmWord(call.alarm.alarm)} ${who} in ${incident.name}.`)
    .join(" ");
}

/**
 * Whether the alarm must sound: a call that nobody has answered. One of an import or an exercise has a clock
 * of its own: it is shown, but nobody is to be startled by a mayday of last year.
 */
export function mustSound(calls: readonly CallElsewhere[]): boolean {
  return calls.some(({ incident, call }) => !call.acknowledged && incident.clock === "live");
}
