/** Who is called alike: two units with one callsign, as after a change of units, or by a slip in the list. */
import { isMoving } from "../fixes/staleness";
import type { FrameNode } from "../types";

type Called = Pick<FrameNode, "node" | "callsign" | "role" | "status">;

/**
 * Callsigns that tell apart who is called alike, by node: "E7-1 (ff2)". Nothing for everybody else, nor for who is not
 * tracked any more.
 */
export function toldApart(states: Iterable<Called>): ReadonlyMap<string, string> {
  const called = new Map<string, Called[]>();
  for (const state of states) {
    if (!isMoving(state.role) || state.status === "retired") continue;
    const name = state.callsign || state.node;
    const alike = called.get(name);
    if (alike) alike.push(state);
    else called.set(name, [state]);
  }
  const found = new Map<string, string>();
  for (const [name, alike] of called) {
    if (alike.length === 1) continue;
    // The name of a node is one of a kind.
    for (const { node } of alike) if (node !== name) found.set(node, `${name} (${node})`);
  }
  return found;
}
