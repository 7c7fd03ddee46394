/** The chain of breadcrumbs, relay by relay, back to the base. */
import { type ChainLink, relayChain } from "../domain/map/chain";
import { toScreen } from "../domain/map/view";
import type { Picture } from "../domain/picture";
import type { Layer } from "./layer";
import { placed } from "./place";

/** The tree is worked out again at most this often: it costs the square of the number of radios (ms). */
const KEPT_MS = 1000;

let kept: { incident: string; atMs: number; links: readonly ChainLink[] } | null = null;

function linksOf(picture: Picture): readonly ChainLink[] {
  const atMs = performance.now();
  if (kept === null || kept.incident !== picture.incident || atMs - kept.atMs > KEPT_MS) {
    kept = { incident: picture.incident, atMs, links: relayChain(picture) };
  }
  return kept.links;
}

export const chain: Layer = {
  draw(context, scene) {
    if (scene.picture === null) return;
    const elsewhere = new Set(placed(scene).flatMap((place) => (place.elsewhere ? [place.node.node] : [])));
    context.save();
    context.strokeStyle = scene.palette.radio;
    context.lineWidth = 1.5;
    context.setLineDash([2, 6]);
    context.beginPath();
    for (const { from, to } of linksOf(scene.picture)) {
      const a = scene.picture.nodes.get(from)?.state.position_m;
      const b = scene.picture.nodes.get(to)?.state.position_m;
      if (a == null || b == null || (elsewhere.has(from) && elsewhere.has(to))) continue;
      context.moveTo(...toScreen(scene.view, a[0], a[1]));
      context.lineTo(...toScreen(scene.view, b[0], b[1]));
    }
    context.stroke();
    context.restore();
  },
};
