/** Where everybody was as known now, beside where they were shown then: crosses, thin rings, thin trails. */

import { pointAt } from "../domain/fixes/known-now";
import { ellipseOf } from "../domain/map/ellipse";
import { toScreen } from "../domain/map/view";
import { levelWords, nameInText, nameOf } from "../domain/words";
import type { Layer, Scene } from "./layer";
import { markReach } from "./place";

/** A cross is open in its middle: what it lies over is read through it (CSS pixels). */
const INNER_PX = 8;
const OUTER_PX = 15;
const LEAST_RING_PX = 19;
/** A point of a thin trail each so many seconds. */
const TRAIL_STEP_S = 2;
/** Further from its mark than this a cross says whose it is (CSS pixels). */
const NAMED_FROM_PX = 40;

export const known: Layer = {
  draw(context, scene) {
    context.save();
    context.lineCap = context.lineJoin = "round";
    for (const one of scene.knownNow.values()) {
      const node = scene.picture?.nodes.get(one.node)?.state;
      if (node === undefined) continue;
      const [x, y] = toScreen(scene.view, one.position[0], one.position[1]);
      const shown = node.position_m && toScreen(scene.view, node.position_m[0], node.position_m[1]);
      const here = scene.level === "all" || [one.level, node.level ?? null].includes(scene.level);
      if (!here && node.role !== "uav" && !scene.alarms.has(node.node)) continue;
      const reach = markReach(scene, node);
      if (node.role !== "uav") trail(context, scene, one.node);
      const { major_m, minor_m, angle_rad } = ellipseOf(one.covariance);
      const scale = scene.view.pixelsPerMetre;
      const off = shown ? Math.hypot(x - shown[0], y - shown[1]) : Number.POSITIVE_INFINITY;
      twice(context, scene, 1.25, () => {
        context.ellipse(
          x,
          y,
          Math.max(LEAST_RING_PX, major_m * scale),
          Math.max(LEAST_RING_PX, minor_m * scale),
          -angle_rad,
          0,
          2 * Math.PI,
        );
      });
      twice(context, scene, 3, () => {
        if (shown && off > reach) {
          context.moveTo(
            shown[0] + ((x - shown[0]) * reach) / off,
            shown[1] + ((y - shown[1]) * reach) / off,
          );
          context.lineTo(x, y);
        }
        for (const [across, along] of [
          [1, 1],
          [1, -1],
          [-1, 1],
          [-1, -1],
        ] as const) {
          context.moveTo(x + across * INNER_PX, y + along * INNER_PX);
          context.lineTo(x + across * OUTER_PX, y + along * OUTER_PX);
        }
      });
      if (off < NAMED_FROM_PX && !one.otherStorey) continue;
      const storey = one.otherStorey ? `: ${levelWords(one.level, scene.levels)}` : "";
      write(context, scene, `${nameInText(nameOf(node))} now known${storey}`, x, y + LEAST_RING_PX + 4);
    }
    context.restore();
  },
};

/** In the ink of words, on an edge of the ground: told from everything under it, by day and by night. */
function twice(context: CanvasRenderingContext2D, scene: Scene, width: number, path: () => void): void {
  context.beginPath();
  path();
  context.strokeStyle = scene.palette.ground;
  context.lineWidth = width + 3;
  context.stroke();
  context.strokeStyle = scene.palette.ink;
  context.lineWidth = width;
  context.stroke();
}

function trail(context: CanvasRenderingContext2D, scene: Scene, node: string): void {
  const track = scene.knownTracks.find((one) => one.node === node);
  if (track === undefined || scene.trail_s <= 0) return;
  context.beginPath();
  let drawn = false;
  for (let t = scene.now - scene.trail_s; t <= scene.now; t += TRAIL_STEP_S) {
    const point = pointAt(track, t);
    if (point === null) {
      drawn = false;
      continue;
    }
    const [x, y] = toScreen(scene.view, point.position[0], point.position[1]);
    if (drawn) context.lineTo(x, y);
    else context.moveTo(x, y);
    drawn = true;
  }
  context.strokeStyle = scene.palette.ink;
  context.globalAlpha = 0.7;
  context.lineWidth = 1;
  context.stroke();
  context.globalAlpha = 1;
}

function write(context: CanvasRenderingContext2D, scene: Scene, text: string, x: number, y: number): void {
  context.font = `600 ${13 * scene.view.text}px system-ui, sans-serif`;
  context.textAlign = "center";
  context.textBaseline = "top";
  const width = context.measureText(text).width + 8;
  context.globalAlpha = 0.82;
  context.fillStyle = scene.palette.panel;
  context.fillRect(x - width / 2, y - 1, width, 17 * scene.view.text);
  context.globalAlpha = 1;
  context.fillStyle = scene.palette.ink;
  context.fillText(text, x, y);
}
