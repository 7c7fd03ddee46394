/** What of the map everybody needs who is on it, with how sure that is. */

import type { Picture } from "../picture";
import type { FrameNode, Position } from "../types";
import { K95 } from "./ellipse";
import { type Bounds, boundsOf, LEAST_SPAN_M } from "./view";

export type PlacedNode = Pick<FrameNode, "node" | "role" | "covariance_m2"> & {
  readonly position_m: Position;
};

/** Who is on the map. */
export interface Around {
  /** Whom it is fitted to. */
  readonly seen: readonly PlacedNode[];
  /** Whom it is not fitted to, and who had better not lie under a button all the same. */
  readonly beside: readonly PlacedNode[];
}

/** Who is out is not there, and a UAV is outside, but for one that is chosen, or where there is nobody else. */
export function around(picture: Picture | null, selected: string | null): Around {
  const all = [...(picture?.nodes.values() ?? [])].flatMap(({ state }) =>
    state.position_m == null || state.status === "retired" ? [] : { ...state, position_m: state.position_m },
  );
  const isBeside = ({ role, node }: PlacedNode) => role === "uav" && node !== selected;
  if (all.every(isBeside)) return { seen: all, beside: [] };
  return { seen: all.filter((node) => !isBeside(node)), beside: all.filter(isBeside) };
}

/** The box around the marks of nodes; null where there are none. */
export function boundsOfMarks(nodes: readonly PlacedNode[]): Bounds | null {
  return boundsOf(nodes.map(({ position_m }) => position_m));
}

/**
 * The box around nodes and the 95 % ellipses of responders; null where there are none. No ellipse reaches
 * farther than half of what the marks span: one who is lost must not make all others a dot.
 */
export function boundsAround(nodes: readonly PlacedNode[]): Bounds | null {
  const marks = boundsOfMarks(nodes);
  if (marks === null) return null;
  const most_m = Math.max(LEAST_SPAN_M, marks.east_m - marks.west_m, marks.north_m - marks.south_m) / 2;
  const reach_m = (variance_m2: number) => Math.min(most_m, K95 * Math.sqrt(Math.max(0, variance_m2)));
  return boundsOf(
    nodes.flatMap(({ role, position_m, covariance_m2 }): Position[] => {
      if (role !== "responder" || covariance_m2 == null) return [position_m];
      const [e, n, u] = position_m;
      const [east_m, north_m] = [reach_m(covariance_m2[0]), reach_m(covariance_m2[3])];
      return [
        [e - east_m, n - north_m, u],
        [e + east_m, n + north_m, u],
      ];
    }),
  );
}
