/** How sure each fix is: the filled and bordered 95 % ellipse, never a fade, never too small to see. */

import { covarianceAt, isMoving, statusAt } from "../domain/fixes/staleness";
import { ellipseOf } from "../domain/map/ellipse";
import { markOf } from "../domain/people/crews";
import type { Status } from "../domain/types";
import type { Layer, Placed, Scene } from "./layer";
import { markReach, movers, radios } from "./place";

/** However sure the fix is, its ellipse shows this far outside the mark (px). */
const LEAST_OUTSIDE_PX = 5;
const LEAST_AROUND_RADIO_PX = 12;
/** A larger ellipse than this is filled the less, the larger it is, so that one who is lost does not wash over all others. */
const WHOLE_FILL_PX = 110;
const FAINTEST = 0.2;
/** All fills together tint the map no more than this: of a dozen who are lost, the borders tell it as well. */
const MOST_TINT = 0.06;
/** Dash of the border by status: whole, broken, dotted. */
export const DASHES: Record<Status, number[]> = { live: [], stale: [9, 5], lost: [2, 6], retired: [1, 8] };

/** An ellipse as it is drawn: its half axes in CSS pixels, and how strong its fill is alone. */
interface Drawn {
  readonly place: Placed;
  readonly colour: string;
  readonly majorPx: number;
  readonly minorPx: number;
  readonly angle_rad: number;
  readonly fill: number;
  /** It is filled in full, however many others there are. */
  readonly urgent: boolean;
}

export const ellipses: Layer = {
  draw(context, scene) {
    const chosen = radios(scene).filter(({ node }) => node.node === scene.selected);
    const all = [...chosen, ...movers(scene)]
      .filter(({ node, elsewhere }) => !elsewhere && node.status !== "retired")
      .flatMap((place) => drawn(scene, place) ?? []);
    const share = fillShare(all, scene.view.width * scene.view.height);
    context.save();
    for (const one of all) draw(context, scene, one, one.urgent ? one.fill : one.fill * share);
    context.restore();
  },
};

/** The share of their fills that keeps all of them together from tinting a map of this area (px²). */
export function fillShare(
  all: readonly Pick<Drawn, "majorPx" | "minorPx" | "fill" | "urgent">[],
  mapPx2: number,
): number {
  let tint = 0;
  for (const { majorPx, minorPx, fill, urgent } of all) {
    if (!urgent) tint += fill * Math.min(1, (Math.PI * majorPx * minorPx) / mapPx2);
  }
  return Math.min(1, MOST_TINT / tint);
}

function drawn(scene: Scene, place: Placed): Drawn | null {
  const { node } = place;
  const sighting = scene.picture?.nodes.get(node.node);
  const covariance = sighting && covarianceAt(sighting, scene.now);
  if (!covariance) return null;
  const { major_m, minor_m, angle_rad } = ellipseOf(covariance);
  const selected = node.node === scene.selected;
  const alarm = scene.alarms.has(node.node);
  const least = isMoving(node.role) ? markReach(scene, node) + LEAST_OUTSIDE_PX : LEAST_AROUND_RADIO_PX;
  const majorPx = Math.max(least, major_m * scene.view.pixelsPerMetre);
  const minorPx = Math.max(least, minor_m * scene.view.pixelsPerMetre);
  const strength = Math.min(1, Math.max(FAINTEST, WHOLE_FILL_PX ** 2 / (majorPx * minorPx)));
  return {
    place,
    colour: alarm ? scene.palette.alarm : markOf(node, scene.crews).line[scene.palette.shade],
    majorPx,
    minorPx,
    angle_rad,
    fill: (selected ? 0.26 : 0.15) * strength,
    urgent: selected || alarm,
  };
}

function draw(context: CanvasRenderingContext2D, scene: Scene, one: Drawn, fill: number): void {
  const { node, x, y } = one.place;
  context.beginPath();
  context.ellipse(x, y, one.majorPx, one.minorPx, -one.angle_rad, 0, 2 * Math.PI);
  context.fillStyle = context.strokeStyle = one.colour;
  context.globalAlpha = fill;
  context.fill();
  context.globalAlpha = 0.95;
  context.lineWidth = node.node === scene.selected ? 3 : 1.75;
  context.setLineDash(DASHES[statusAt(node, scene.now, scene.limits)]);
  context.stroke();
  context.setLineDash([]);
}
