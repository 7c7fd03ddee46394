/** Responders and UAVs: shape and dash tell live, stale and lost; colour tells the crew; red tells alarm. */

import { statusAt } from "../domain/fixes/staleness";
import { markOf } from "../domain/people/crews";
import type { Status } from "../domain/types";
import type { Layer, Placed, Scene } from "./layer";
import { ALARM_RADIUS, CHOSEN_RADIUS, movers, RADIUS, STALE_RADIUS } from "./place";

/** Of the stale diamond: as large to the eye as the circle. */
const STALE_FILL = RADIUS + 2;
const TICK = 11;

export const responders: Layer = {
  draw(context, scene) {
    context.save();
    for (const place of movers(scene)) draw(context, scene, place);
    context.restore();
  },
};

function draw(context: CanvasRenderingContext2D, scene: Scene, { node, x, y, elsewhere }: Placed): void {
  const status = statusAt(node, scene.now, scene.limits);
  const mark = markOf(node, scene.crews);
  const line = mark.line[scene.palette.shade];
  const alarm = scene.alarms.has(node.node);
  context.globalAlpha = elsewhere ? 0.3 : status === "retired" && !alarm ? 0.4 : 1;
  if (node.node === scene.selected) {
    context.strokeStyle = scene.palette.ink;
    context.lineWidth = 3;
    circle(context, x, y, CHOSEN_RADIUS);
    context.stroke();
  }
  if (alarm) {
    context.fillStyle = scene.palette.alarm;
    circle(context, x, y, ALARM_RADIUS);
    context.fill();
  }
  if (node.heading_rad != null && status === "live" && node.role !== "uav") {
    context.strokeStyle = line;
    context.lineWidth = 4;
    context.beginPath();
    const [east, north] = [Math.cos(node.heading_rad), Math.sin(node.heading_rad)];
    context.moveTo(x + RADIUS * east, y - RADIUS * north);
    context.lineTo(x + (RADIUS + TICK) * east, y - (RADIUS + TICK) * north);
    context.stroke();
  }
  const shape = node.role === "uav" ? "uav" : status;
  const gone = status === "lost" || status === "retired";
  outline(context, shape, x, y);
  context.fillStyle = gone ? scene.palette.ground : mark.colour;
  context.fill();
  context.strokeStyle = gone ? line : scene.palette.ground;
  context.lineWidth = gone ? 3 : 1.5;
  context.setLineDash(gone ? [5, 3] : []);
  context.stroke();
  if (status === "stale") {
    // Apart from the fill and in another colour: dashes on the edge of their own fill look like a cogwheel.
    outline(context, shape, x, y, STALE_RADIUS - STALE_FILL);
    context.strokeStyle = alarm ? scene.palette.alarmInk : scene.palette.ink;
    context.lineWidth = 2;
    context.setLineDash([6, 4]);
    context.stroke();
  }
  context.setLineDash([]);
  context.fillStyle = gone ? scene.palette.ink : mark.ink;
  // A triangle is as wide as its letters near its foot only.
  const [letters_px, lower] = shape === "uav" ? [9, 5] : [11, 0.5];
  context.font = `700 ${letters_px}px system-ui, sans-serif`;
  context.textAlign = "center";
  context.textBaseline = "middle";
  context.fillText(status === "lost" ? "?" : mark.letters, x, y + lower);
}

/** Live is round, stale a diamond, lost a square; a UAV is a triangle that points up. `wider` by some pixels. */
function outline(
  context: CanvasRenderingContext2D,
  shape: Status | "uav",
  x: number,
  y: number,
  wider = 0,
): void {
  context.beginPath();
  if (shape === "uav") {
    context.moveTo(x, y - RADIUS - 4 - wider);
    context.lineTo(x + RADIUS + 4 + wider, y + RADIUS - 2 + wider / 2);
    context.lineTo(x - RADIUS - 4 - wider, y + RADIUS - 2 + wider / 2);
    context.closePath();
  } else if (shape === "stale") {
    const r = STALE_FILL + wider;
    context.moveTo(x, y - r);
    context.lineTo(x + r, y);
    context.lineTo(x, y + r);
    context.lineTo(x - r, y);
    context.closePath();
  } else if (shape === "lost") {
    context.rect(x - RADIUS + 1, y - RADIUS + 1, 2 * RADIUS - 2, 2 * RADIUS - 2);
  } else {
    context.arc(x, y, RADIUS, 0, 2 * Math.PI);
  }
}

function circle(context: CanvasRenderingContext2D, x: number, y: number, radius: number): void {
  context.beginPath();
  context.arc(x, y, radius, 0, 2 * Math.PI);
}
