/** The relay chain: which breadcrumb most likely relays for which, by nearness. */
import type { Picture } from "../picture";
import type { Position } from "../types";

export interface ChainLink {
  readonly from: string;
  readonly to: string;
}

interface Radio {
  readonly node: string;
  readonly position: Position;
}

/**
 * The shortest tree over base stations and breadcrumbs (Prim). It says which relay is next on the
 * way out by distance; it does not claim a radio link.
 */
export function relayChain(picture: Picture): ChainLink[] {
  const radios: Radio[] = [];
  const bases: Radio[] = [];
  for (const { state } of picture.nodes.values()) {
    const position = state.position_m;
    if (position == null || state.status === "retired") continue;
    if (state.role === "base") bases.push({ node: state.node, position });
    else if (state.role === "breadcrumb") radios.push({ node: state.node, position });
  }
  const links: ChainLink[] = [];
  const root = bases[0] ?? radios.shift();
  if (root === undefined) return links;
  const nearest = radios.map((radio) => ({ radio, to: root, distance2: distance2(radio, root) }));
  while (nearest.length > 0) {
    let best = 0;
    for (let i = 1; i < nearest.length; i += 1) {
      if ((nearest[i]?.distance2 ?? 0) < (nearest[best]?.distance2 ?? 0)) best = i;
    }
    const [next] = nearest.splice(best, 1);
    if (next === undefined) break;
    links.push({ from: next.to.node, to: next.radio.node });
    for (const open of nearest) {
      const d2 = distance2(open.radio, next.radio);
      if (d2 < open.distance2) {
        open.distance2 = d2;
        open.to = next.radio;
      }
    }
  }
  return links;
}

function distance2(a: Radio, b: Radio): number {
  return (
    (a.position[0] - b.position[0]) ** 2 +
    (a.position[1] - b.position[1]) ** 2 +
    (a.position[2] - b.position[2]) ** 2
  );
}
