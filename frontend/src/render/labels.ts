/** Who it is and how old the fix is, beside each responder, where there is room. */
import { levelOf } from "../domain/levels";
import { ageS, statusAt } from "../domain/staleness";
import { alarmWord, levelWords, nameOf, shortAge, statusWord } from "../domain/words";
import type { Layer, Placed, Scene } from "./layer";
import { movers } from "./place";
import { RADIUS } from "./responders";

const LINE_PX = 16;
const PADDING = 5;
const NAME_FONT = "600 14px system-ui, sans-serif";
const MOST_WIDTHS = 4000;

interface Box {
  readonly x: number;
  readonly y: number;
  readonly width: number;
  readonly height: number;
}

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
    // A label may cover nobody's mark.
    const taken: Box[] = everybody.flatMap(({ x, y, elsewhere }) =>
      elsewhere ? [] : [{ x: x - RADIUS, y: y - RADIUS, width: 2 * RADIUS, height: 2 * RADIUS }],
    );
    // Whoever matters most is labelled first, and always.
    for (const place of everybody.reverse()) {
      if (place.elsewhere || place.node.status === "retired") continue;
      const urgent = place.node.node === scene.selected || scene.alarms.has(place.node.node);
      const lines = words(scene, place);
      const width = Math.max(...lines.map((line) => widthOf(context, line))) + 2 * PADDING;
      const box =
        room(place, width, lines.length * LINE_PX + PADDING, taken) ?? (urgent ? beside(place, width) : null);
      if (box === null) continue;
      taken.push(box);
      write(context, scene, place, lines, box);
    }
    context.restore();
  },
};

function words(scene: Scene, { node }: Placed): string[] {
  const status = statusAt(node, scene.now, scene.limits);
  const alarm = scene.alarms.get(node.node);
  const age = shortAge(ageS(node, scene.now));
  const lines = [alarm ? `${nameOf(node)} ${alarmWord(alarm.alarm)}` : nameOf(node)];
  lines.push(status === "live" ? age : `${statusWord(status).toUpperCase()} ${age}`);
  const level = levelOf(node, scene.levels);
  if (scene.level === "all" && level !== null && node.role !== "uav" && lines[1] !== undefined) {
    lines[1] += ` · ${levelWords(level, scene.levels)}`;
  }
  return lines;
}

/** A free place at the right, left, below or above, then at the corners; null where there is none. */
function room({ x, y }: Placed, width: number, height: number, taken: readonly Box[]): Box | null {
  const away = RADIUS + 6;
  const places: Box[] = [
    { x: x + away, y: y - height / 2, width, height },
    { x: x - away - width, y: y - height / 2, width, height },
    { x: x - width / 2, y: y + away, width, height },
    { x: x - width / 2, y: y - away - height, width, height },
    { x: x + away, y: y + away / 2, width, height },
    { x: x + away, y: y - away / 2 - height, width, height },
    { x: x - away - width, y: y + away / 2, width, height },
    { x: x - away - width, y: y - away / 2 - height, width, height },
  ];
  return places.find((box) => !taken.some((other) => overlap(box, other))) ?? null;
}

function beside({ x, y }: Placed, width: number): Box {
  return { x: x + RADIUS + 6, y: y - LINE_PX, width, height: 2 * LINE_PX + PADDING };
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
