/** Where nodes are drawn, and which one a finger means. */

import { levelOf } from "../domain/fixes/levels";
import { isMoving, statusAt } from "../domain/fixes/staleness";
import { toScreen } from "../domain/map/view";
import { isLowOnAir } from "../domain/people/air";
import type { FrameNode, Status } from "../domain/types";
import type { Placed, Scene } from "./layer";

/** Of a responder's mark (CSS pixels). */
export const RADIUS = 13;
/** Of the broken edge around a stale one, of the red under one in alarm, of the ring around the chosen one. */
export const STALE_RADIUS = 20;
export const ALARM_RADIUS = 21;
export const CHOSEN_RADIUS = 24;
/** Nodes this far outside the map are not drawn (CSS pixels). */
const BEYOND = 60;
/** A finger in a glove: half of a 44 px target. */
const REACH = 22;

const placedOf = new WeakMap<Scene, readonly Placed[]>();

/** All nodes with a position near the map, worked out once for a scene. */
export function placed(scene: Scene): readonly Placed[] {
  const known = placedOf.get(scene);
  if (known !== undefined) return known;
  const { view, level, levels, picture, alarms } = scene;
  const all: Placed[] = [];
  for (const { state: node } of picture?.nodes.values() ?? []) {
    if (node.position_m == null) continue;
    const [x, y] = toScreen(view, node.position_m[0], node.position_m[1]);
    if (x < -BEYOND || y < -BEYOND || x > view.width + BEYOND || y > view.height + BEYOND) continue;
    const on = level === "all" ? level : levelOf(node, levels);
    // What flies outside belongs to every storey, and who is in alarm concerns whoever looks at another one.
    const everywhere = node.role === "uav" || alarms.has(node.node);
    all.push({ node, x, y, elsewhere: !everywhere && on !== null && on !== level });
  }
  placedOf.set(scene, all);
  return all;
}

const WORSE: Record<Status, number> = { retired: 0, live: 0, stale: 1, lost: 2 };

/** How much a responder matters to who looks: those not heard more than those live, then low air, alarm and choice. */
export function rankOf(scene: Scene, node: FrameNode): number {
  if (node.node === scene.selected) return 4;
  if (scene.alarms.has(node.node)) return 3;
  return isLowOnAir(node) ? 2.5 : WORSE[statusAt(node, scene.now, scene.limits)];
}

/** Responders and UAVs, those that matter most last, so that they lie on top. */
export function movers(scene: Scene): Placed[] {
  return placed(scene)
    .filter(({ node }) => isMoving(node.role))
    .map((place) => ({
      place,
      rank: place.elsewhere && place.node.node !== scene.selected ? -1 : rankOf(scene, place.node),
    }))
    .sort((a, b) => a.rank - b.rank)
    .map(({ place }) => place);
}

/** How far from its place a responder's mark goes, with the rings that alarm and choice put around it (CSS pixels). */
export function markReach(scene: Scene, node: FrameNode): number {
  if (node.node === scene.selected) return CHOSEN_RADIUS + 2;
  if (scene.alarms.has(node.node)) return ALARM_RADIUS;
  return statusAt(node, scene.now, scene.limits) === "stale" ? STALE_RADIUS : RADIUS;
}

/** Nodes that stand. */
export function radios(scene: Scene): Placed[] {
  return placed(scene).filter(({ node }) => !isMoving(node.role));
}

/** The node under a finger; responders before radios, the nearest first. */
export function hit(scene: Scene, x: number, y: number): string | null {
  let best: { node: string; distance: number } | null = null;
  for (const place of placed(scene)) {
    if (place.elsewhere) continue;
    const reach = isMoving(place.node.role) ? REACH : REACH * 0.7;
    const distance = Math.hypot(place.x - x, place.y - y) + (isMoving(place.node.role) ? 0 : REACH / 2);
    if (distance <= reach && (best === null || distance < best.distance)) {
      best = { node: place.node.node, distance };
    }
  }
  return best?.node ?? null;
}
