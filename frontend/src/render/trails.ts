/** Where each responder went, for as long back as was chosen; older parts are fainter. */

import type { Trail, Trails } from "../domain/map/trails";
import { toScreen, type View } from "../domain/map/view";
import { markOf } from "../domain/people/crews";
import type { Layer, Scene } from "./layer";
import { movers } from "./place";

/** Parts of a trail, each fainter than the one after it. */
const PARTS = 4;
/** A step between two points longer than this is a gap, and not drawn as a walk (s). */
const GAP_S = 15;
/** Steps shorter than this are not seen on the map, and dear to draw (CSS pixels). */
const LEAST_STEP_PX = 5;

/** Its oldest end may linger so long: a share of the trail's length. */
const KEPT = 1 / 60;

/** Where a part of a trail begins, turns, ends; `gap`: the walk there is not known. */
export function* corners(
  trail: Trail,
  view: View,
  begin: number,
  end: number,
): Generator<{ x: number; y: number; gap: boolean }> {
  let [lastX, lastY] = [0, 0];
  for (let i = begin; i <= end; i += 1) {
    const [x, y] = toScreen(view, trail.east(i), trail.north(i));
    const gap = i === begin || trail.time(i) - trail.time(i - 1) > GAP_S;
    if (!gap && i < end && Math.hypot(x - lastX, y - lastY) < LEAST_STEP_PX) continue;
    [lastX, lastY] = [x, y];
    yield { x, y, gap };
  }
}

/** What has been walked by a moment, as it was drawn: it hardly changes, and is dear to draw anew. */
export interface Walked {
  readonly view: View;
  readonly now: number;
  readonly incident: string | undefined;
  readonly trails: Trails;
  /** Whose trails, and how they look. */
  readonly shown: string;
}

let kept: (Walked & { readonly canvas: HTMLCanvasElement }) | null = null;

export const trails: Layer = {
  draw(context, scene, moving) {
    if (scene.trail_s <= 0) return;
    const wanted = walkedOf(scene);
    if (kept === null || !stillHolds(kept, wanted, scene.trail_s, moving)) {
      kept = { ...wanted, canvas: drawn(context.canvas, scene, kept?.canvas) };
    }
    const { view, canvas, now } = kept;
    const larger = scene.view.pixelsPerMetre / view.pixelsPerMetre;
    context.save();
    context.translate(...toScreen(scene.view, view.east_m, view.north_m));
    context.scale(larger, larger);
    context.drawImage(canvas, -view.width / 2, -view.height / 2, view.width, view.height);
    context.restore();
    stroke(context, scene, now);
  },
};

export function walkedOf(scene: Scene): Walked {
  const people = movers(scene).flatMap(({ node, elsewhere }) =>
    elsewhere ? [] : [node.node + markOf(node, scene.crews).line[scene.palette.shade]],
  );
  const shown = [scene.trail_s, scene.trails.version, scene.selected, ...people].join(" ");
  return { view: scene.view, now: scene.now, incident: scene.picture?.incident, trails: scene.trails, shown };
}

/**
 * Whether what was drawn is what is to be shown now, but for the last steps.
 *
 * @param moving the map is under a finger: until it rests, what was drawn moves along.
 */
export function stillHolds(drawn: Walked, wanted: Walked, trail_s: number, moving: boolean): boolean {
  const later_s = wanted.now - drawn.now;
  if (later_s < 0 || later_s > KEPT * trail_s || drawn.incident !== wanted.incident) return false;
  if (drawn.trails !== wanted.trails) return false;
  return moving || (drawn.view === wanted.view && drawn.shown === wanted.shown);
}

function drawn(
  { width, height }: HTMLCanvasElement,
  scene: Scene,
  canvas = document.createElement("canvas"),
): HTMLCanvasElement {
  // Its size, newly set, wipes it.
  canvas.width = width;
  canvas.height = height;
  const context = canvas.getContext("2d");
  const ratio = width / scene.view.width;
  context?.setTransform(ratio, 0, 0, ratio, 0, 0);
  if (context !== null) stroke(context, scene, null);
  return canvas;
}

/** Everybody's trail: all that is shown of it, or only what was walked since a moment. */
function stroke(context: CanvasRenderingContext2D, scene: Scene, since: number | null): void {
  context.save();
  context.lineJoin = context.lineCap = "round";
  for (const { node, elsewhere } of movers(scene)) {
    const trail = scene.trails.of(node.node);
    // An aircraft circles outside: its trail would only cover the others'.
    if (trail === undefined || elsewhere || node.role === "uav") continue;
    const selected = node.node === scene.selected;
    context.strokeStyle = markOf(node, scene.crews).line[scene.palette.shade];
    context.lineWidth = selected ? 4 : 2.5;
    for (const { begin, end, part } of since === null ? partsOf(trail, scene) : lastOf(trail, scene, since)) {
      context.globalAlpha = (selected ? 0.35 : 0.15) + (0.5 * part) / (PARTS - 1);
      context.beginPath();
      for (const { x, y, gap } of corners(trail, scene.view, begin, end)) {
        if (gap) context.moveTo(x, y);
        else context.lineTo(x, y);
      }
      context.stroke();
    }
  }
  context.restore();
}

interface Part {
  readonly begin: number;
  readonly end: number;
  /** 0 is the oldest. */
  readonly part: number;
}

function partsOf(trail: Trail, { now, trail_s }: Scene): Part[] {
  const from = now - trail_s;
  return Array.from({ length: PARTS }, (_, part) => {
    const begin = trail.firstFrom(from + (trail_s * part) / PARTS);
    const until = trail.firstFrom(from + (trail_s * (part + 1)) / PARTS);
    return { begin, end: part === PARTS - 1 ? newest(trail, now) : Math.min(trail.length - 1, until), part };
  });
}

function lastOf(trail: Trail, { now }: Scene, since: number): Part[] {
  const [begin, end] = [newest(trail, since), newest(trail, now)];
  return end > begin ? [{ begin: Math.max(0, begin), end, part: PARTS - 1 }] : [];
}

/** A replay shows an earlier moment: what was walked later is not known then. */
function newest(trail: Trail, now: number): number {
  return trail.firstFrom(now + 0.5) - 1;
}
