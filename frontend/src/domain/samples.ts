/** Nodes, alarms and frames for the tests of this folder: plain ones, with what a test is about put over them. */
import { type Picture, pictureOf } from "./picture";
import type { DeltaMessage, FrameAlarm, FrameMessage, FrameNode, Incident, Level } from "./types";

/** Noon of a day; tests count from here (Unix s). */
export const NOON = 1_763_712_000;

export const STOREYS: Level[] = [
  { level: 0, name: "G", up_m: 0 },
  { level: 1, name: "1", up_m: 3.2 },
  { level: 2, name: "2", up_m: 6.4 },
];

export function aNode(over: Partial<FrameNode> = {}): FrameNode {
  return {
    node: "ff1",
    role: "responder",
    callsign: "E7-1",
    crew: "E7",
    position_m: [0, 0, 0],
    covariance_m2: [1, 0, 0, 1, 0, 1],
    heading_rad: null,
    heading_sigma_rad: null,
    speed_mps: null,
    level: null,
    level_p: null,
    t: NOON,
    status: "live",
    battery: null,
    air_bar: null,
    temperature_c: null,
    motionless_s: null,
    moved: false,
    retire_reason: null,
    ...over,
  };
}

export function anAlarm(over: Partial<FrameAlarm> = {}): FrameAlarm {
  return { node: "ff1", alarm: "mayday", state: "raised", t: NOON, text: null, ...over };
}

/** What the server says when the estimator of an incident could not go on. */
export const A_BREAK = { code: "estimator_failed", t: NOON, text: "It broke.", node: null } as const;

/** What it says when something reported has not been in the picture for seconds. */
export const A_DELAY = { code: "estimator_behind", t: NOON, text: "It is behind.", node: null } as const;

const NOTHING_ELSE = { alarms: [], notices: [], set_aside: [], clocks: [] };

export function aFrame(nodes: FrameNode[], over: Partial<FrameMessage> = {}): FrameMessage {
  const times = { t: NOON, clock_t: NOON, newest_t: NOON };
  return {
    type: "frame",
    incident: "i1",
    seq: 1,
    ...times,
    nodes,
    ...NOTHING_ELSE,
    ...over,
  };
}

export function aDelta(nodes: FrameNode[], over: Partial<DeltaMessage> = {}): DeltaMessage {
  const times = { t: NOON + 1, clock_t: NOON + 1, newest_t: NOON + 1 };
  return {
    type: "delta",
    incident: "i1",
    seq: 2,
    ...times,
    nodes,
    ...NOTHING_ELSE,
    ...over,
  };
}

export function pictureWith(...nodes: FrameNode[]): Picture {
  return pictureOf(aFrame(nodes));
}

export function anIncident(over: Partial<Incident> = {}): Incident {
  return {
    id: "i1",
    name: "Office fire",
    clock: "live",
    state: "active",
    origin: null,
    levels: STOREYS,
    settings: {},
    created: NOON,
    closed: null,
    last_seq: 0,
    first_t: null,
    earliest_t: null,
    last_t: null,
    stretches: [],
    ...over,
  };
}
