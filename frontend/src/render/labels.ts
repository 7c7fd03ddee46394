/** Who it is and how old the fix is, beside each responder, where there is room. */
import { labelLines } from "../domain/label";
import type { View } from "../domain/view";
import type { Box, Layer, Placed, Scene } from "./layer";
import { markReach, movers, RADIUS } from "./place";

const LINE_PX = 16;
const PADDING = 5;
const BESIDE_PX = 6;
const NAME_FONT = "600 14px system-ui, sans-serif";
const MOST_WIDTHS = 4000;

const widths = new Map<string, number>();

/** Measuring text is dear: each text is measured once. */
function widthOf(context: CanvasRenderingContext2D, text: string): number {
  let width = widths.get(text);
  if (width === undefined) {
    if (widths.size > MOST_WIDTHS) widths.clear();
    width = context.measureText(text).width;
    widths.set(text, width);
  }
  return width;
}

export const labels: Layer = {
  draw(context, scene) {
    context.save();
    context.font = NAME_FONT;
    context.textAlign = "left";
    context.textBaseline = "top";
    const everybody = movers(scene);
    // A label may cover nobody's mark, nor lie under what lies over the map.
    const taken: Box[] = everybody.flatMap(({ x, y, elsewhere }) =>
      elsewhere ? [] : [{ x: x - RADIUS, y: y - RADIUS, width: 2 * RADIUS, height: 2 * RADIUS }],
    );
    taken.push(...scene.covered);
    // Whoever matters most is labelled first, and always.
    for (const place of everybody.reverse()) {
      const urgent = place.node.node === scene.selected || scene.alarms.has(place.node.node);
      if ((place.elsewhere && !urgent) || place.node.status === "retired") continue;
      const lines = labelLines(place.node, scene);
      const away = markReach(scene, place.node) + BESIDE_PX;
      const width = Math.max(...lines.map((line) => widthOf(context, line))) + 2 * PADDING;
      const height = lines.length * LINE_PX + PADDING;
      const places = around(place, away, width, height).filter((box) => inside(box, scene.view));
      const free = (all: readonly Box[]) => places.find((box) => !all.some((other) => overlap(box, other)));
      const box =
        free(taken) ?? (urgent ? (free(scene.covered) ?? beside(place, away, width, height)) : null);
      if (box === null) continue;
      taken.push(box);
      write(context, scene, place, lines, box);
    }
    context.restore();
  },
};

/** Where a label may go, the best first: at the right, left, below or above, then at the corners. */
function around({ x, y }: Placed, away: number, width: number, height: number): Box[] {
  return [
    { x: x + away, y: y - height / 2, width, height },
    { x: x - away - width, y: y - height / 2, width, height },
    { x: x - width / 2, y: y + away, width, height },
    { x: x - width / 2, y: y - away - height, width, height },
    { x: x + away, y: y + away / 2, width, height },
    { x: x + away, y: y - away / 2 - height, width, height },
    { x: x - away - width, y: y + away / 2, width, height },
    { x: x - away - width, y: y - away / 2 - height, width, height },
  ];
}

/** Where nothing is free and the label must be seen all the same. */
function beside({ x, y }: Placed, away: number, width: number, height: number): Box {
  return { x: x + away, y: y - height / 2, width, height };
}

function inside({ x, y, width, height }: Box, view: View): boolean {
  return x >= 0 && y >= 0 && x + width <= view.width && y + height <= view.height;
}

function overlap(a: Box, b: Box): boolean {
  return a.x < b.x + b.width && b.x < a.x + a.width && a.y < b.y + b.height && b.y < a.y + a.height;
}

function write(
  context: CanvasRenderingContext2D,
  scene: Scene,
  { node }: Placed,
  lines: readonly string[],
  box: Box,
): void {
  const alarm = scene.alarms.has(node.node);
  context.globalAlpha = alarm ? 1 : 0.82;
  context.fillStyle = alarm ? scene.palette.alarm : scene.palette.panel;
  context.beginPath();
  context.roundRect(box.x, box.y, box.width, box.height, 4);
  context.fill();
  context.globalAlpha = 1;
  lines.forEach((line, index) => {
    context.fillStyle = alarm
      ? scene.palette.alarmInk
      : index === 0
        ? scene.palette.ink
        : scene.palette.inkSoft;
    context.fillText(line, box.x + PADDING, box.y + 3 + index * LINE_PX);
  });
}
