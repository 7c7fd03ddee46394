/** How sure each fix is: the filled and bordered 95 % ellipse, never a fade, never too small to see. */
import { markOf } from "../domain/crews";
import { ellipseOf } from "../domain/ellipse";
import { covarianceAt, isMoving, statusAt } from "../domain/staleness";
import type { Status } from "../domain/types";
import type { Layer, Placed, Scene } from "./layer";
import { markReach, movers, radios } from "./place";

/** However sure the fix is, its ellipse shows this far outside the mark (px). */
const LEAST_OUTSIDE_PX = 5;
const LEAST_AROUND_RADIO_PX = 12;
/** A larger ellipse than this is filled the less, the larger it is, so that one who is lost does not wash over all others. */
const WHOLE_FILL_PX = 110;
const FAINTEST = 0.2;
/** Dash of the border by status: whole, broken, dotted. */
export const DASHES: Record<Status, number[]> = { live: [], stale: [9, 5], lost: [2, 6], retired: [1, 8] };

export const ellipses: Layer = {
  draw(context, scene) {
    context.save();
    const chosen = radios(scene).filter(({ node }) => node.node === scene.selected);
    for (const place of [...chosen, ...movers(scene)]) {
      if (!place.elsewhere && place.node.status !== "retired") draw(context, scene, place);
    }
    context.restore();
  },
};

function draw(context: CanvasRenderingContext2D, scene: Scene, { node, x, y }: Placed): void {
  const sighting = scene.picture?.nodes.get(node.node);
  const covariance = sighting && covarianceAt(sighting, scene.now);
  if (!covariance) return;
  const { major_m, minor_m, angle_rad } = ellipseOf(covariance);
  const selected = node.node === scene.selected;
  const least = isMoving(node.role) ? markReach(scene, node) + LEAST_OUTSIDE_PX : LEAST_AROUND_RADIO_PX;
  const majorPx = Math.max(least, major_m * scene.view.pixelsPerMetre);
  const minorPx = Math.max(least, minor_m * scene.view.pixelsPerMetre);
  context.beginPath();
  context.ellipse(x, y, majorPx, minorPx, -angle_rad, 0, 2 * Math.PI);
  const colour = scene.alarms.has(node.node) ? scene.palette.alarm : markOf(node, scene.crews).colour;
  context.fillStyle = colour;
  const strength = Math.min(1, Math.max(FAINTEST, WHOLE_FILL_PX ** 2 / (majorPx * minorPx)));
  context.globalAlpha = (selected ? 0.26 : 0.15) * strength;
  context.fill();
  context.globalAlpha = 0.95;
  context.strokeStyle = colour;
  context.lineWidth = selected ? 3 : 1.75;
  context.setLineDash(DASHES[statusAt(node, scene.now, scene.limits)]);
  context.stroke();
  context.setLineDash([]);
}
