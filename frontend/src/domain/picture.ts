/** The picture on the screen: the newest frame with the deltas since, as an immutable value. */
import { toldApart } from "./people/namesakes";
import type { DeltaMessage, FrameAlarm, FrameMessage, FrameNode } from "./types";

/** A node as the server presented it, and the incident time at which it did. */
export interface Sighting {
  /** With a callsign that tells it from who is called alike. */
  readonly state: FrameNode;
  /** The callsign that it was given. */
  readonly callsign: FrameNode["callsign"];
  readonly presentedT: number;
}

export interface Picture {
  readonly incident: string;
  readonly seq: number;
  readonly t: number;
  /** What "now" was for the incident when this came (Unix s). */
  readonly clockT: number;
  readonly nodes: ReadonlyMap<string, Sighting>;
  readonly alarms: readonly FrameAlarm[];
  /** What the estimator has noticed, or could not take in. */
  readonly notices: FrameMessage["notices"];
  /** Who is heard, and not live on the map, because nothing of it can be used. */
  readonly setAside: FrameMessage["set_aside"];
  /** Clocks that are behind, of gateways that are heard. */
  readonly clocks: FrameMessage["clocks"];
  /** The incident's estimator could not go on: nothing that is reported since is in the picture, no alarm either. */
  readonly standsStill: boolean;
  /** What was last reported is not in the picture yet, and has not been for seconds: an alarm may be missing. */
  readonly behind: boolean;
}

export function standsStill({ notices }: Pick<FrameMessage, "notices">): boolean {
  return notices.some(({ code }) => code === "estimator_failed");
}

export function isBehind({ notices }: Pick<FrameMessage, "notices">): boolean {
  return notices.some(({ code }) => code === "estimator_behind");
}

function sightingOf(state: FrameNode, presentedT: number): Sighting {
  return { state, callsign: state.callsign, presentedT };
}

/** Give who is called alike callsigns of their own, and back what they were given once nobody else is called so. */
function tellApart(nodes: Map<string, Sighting>): void {
  const given = Array.from(nodes.values(), ({ state, callsign }) =>
    state.callsign === callsign ? state : { ...state, callsign },
  );
  const apart = toldApart(given);
  for (const [node, { state, callsign, presentedT }] of nodes) {
    const shown = apart.get(node) ?? callsign;
    if (state.callsign !== shown)
      nodes.set(node, { state: { ...state, callsign: shown }, callsign, presentedT });
  }
}

/** The picture that a whole frame shows. */
export function pictureOf(frame: FrameMessage): Picture {
  const nodes = new Map<string, Sighting>();
  for (const state of frame.nodes) nodes.set(state.node, sightingOf(state, frame.clock_t));
  tellApart(nodes);
  return {
    incident: frame.incident,
    seq: frame.seq,
    t: frame.t,
    clockT: frame.clock_t,
    nodes,
    alarms: frame.alarms,
    notices: frame.notices,
    setAside: frame.set_aside,
    clocks: frame.clocks,
    standsStill: standsStill(frame),
    behind: isBehind(frame),
  };
}

/** The picture after a delta: its nodes replace theirs whole, its alarms are all that stand. */
export function withDelta(picture: Picture, delta: DeltaMessage): Picture {
  const nodes = new Map(picture.nodes);
  for (const state of delta.nodes) nodes.set(state.node, sightingOf(state, delta.clock_t));
  tellApart(nodes);
  return {
    ...picture,
    seq: delta.seq,
    t: delta.t,
    clockT: delta.clock_t,
    nodes,
    alarms: delta.alarms,
    notices: delta.notices,
    setAside: delta.set_aside,
    clocks: delta.clocks,
    standsStill: standsStill(delta),
    behind: isBehind(delta),
  };
}
