/** Whose air is low: where the whistle sounds on his back, and somebody outside must know how long ago that began. */

import { type StalenessLimits, statusAt, toldAt } from "../fixes/staleness";
import type { Picture } from "../picture";
import type { FrameNode } from "../types";
import { airWords, nameOf } from "../words";

export interface LowAir {
  readonly node: string;
  readonly name: string;
  /** "48 bar", and "was 48 bar" of whom nothing is heard. */
  readonly air: string;
  /** Since it was told (s); null where that is not known. */
  readonly age_s: number | null;
}

export function isLowOnAir(node: FrameNode): boolean {
  return node.role === "responder" && node.status !== "retired" && node.air_state === "low";
}

/** Whoever's air is low, the least of it first. */
export function lowOnAir(picture: Picture | null, now: number, limits: StalenessLimits): LowAir[] {
  return [...(picture?.nodes.values() ?? [])]
    .map(({ state }) => state)
    .filter(isLowOnAir)
    .sort((a, b) => (a.air_bar ?? 0) - (b.air_bar ?? 0) || a.node.localeCompare(b.node))
    .map((state) => {
      const { status, age_s, oldAfter_s } = toldAt(state.air_t, statusAt(state, now, limits), now, limits);
      const old = age_s !== null && age_s > oldAfter_s;
      // The age stands beside it, of every report.
      const air = airWords(state.air_bar, { status: old ? "lost" : status, age_s: null, oldAfter_s });
      return { node: state.node, name: nameOf(state), air, age_s };
    });
}

/** What is said beside the pressure: that it is low, or that it is time to turn back. */
export function airStateWords(state: FrameNode["air_state"]): string | null {
  if (state === "low") return "LOW AIR";
  return state === "turn_back" ? "turn back" : null;
}

/** Said aloud once it changes: the very same words as long as nobody else's air is low. */
export function lowAirInWords(low: readonly LowAir[]): string {
  return low.length === 0 ? "" : `Low air: ${low.map(({ name }) => name).join(", ")}.`;
}
