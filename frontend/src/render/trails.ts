/** Where each responder went, for as long back as was chosen; older parts are fainter. */
import { markOf } from "../domain/crews";
import { toScreen } from "../domain/view";
import type { Layer } from "./layer";
import { movers } from "./place";

/** Parts of a trail, each fainter than the one after it. */
const PARTS = 4;
/** A step between two points longer than this is a gap, and not drawn as a walk (s). */
const GAP_S = 15;

export const trails: Layer = {
  draw(context, scene) {
    if (scene.trail_s <= 0) return;
    context.save();
    context.lineJoin = context.lineCap = "round";
    for (const { node, elsewhere } of movers(scene)) {
      const trail = scene.trails.of(node.node);
      // An aircraft circles outside: its trail would only cover the others'.
      if (trail === undefined || elsewhere || node.role === "uav") continue;
      const selected = node.node === scene.selected;
      context.strokeStyle = markOf(node, scene.crews).colour;
      context.lineWidth = selected ? 4 : 2.5;
      const from = scene.now - scene.trail_s;
      for (let part = 0; part < PARTS; part += 1) {
        const begin = trail.firstFrom(from + (scene.trail_s * part) / PARTS);
        const until = trail.firstFrom(from + (scene.trail_s * (part + 1)) / PARTS);
        // A replay shows an earlier moment: what was walked later is not known then.
        const end =
          part === PARTS - 1 ? trail.firstFrom(scene.now + 0.5) - 1 : Math.min(trail.length - 1, until);
        context.globalAlpha = (selected ? 0.35 : 0.15) + (0.5 * part) / (PARTS - 1);
        context.beginPath();
        for (let i = begin; i <= end; i += 1) {
          const [x, y] = toScreen(scene.view, trail.east(i), trail.north(i));
          if (i === begin || trail.time(i) - trail.time(i - 1) > GAP_S) context.moveTo(x, y);
          else context.lineTo(x, y);
        }
        context.stroke();
      }
    }
    context.restore();
  },
};
