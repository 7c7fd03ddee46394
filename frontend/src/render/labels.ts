/** Who it is and how old the fix is, of each responder. */

import { covarianceAt } from "../domain/fixes/staleness";
import { borderOnMap, ce95, ellipseOf } from "../domain/map/ellipse";
import { isNarrow } from "../domain/map/view";
import { isLowOnAir } from "../domain/people/air";
import { type LabelWords, labelWords } from "../domain/people/label";
import { nearest } from "./boxes";
import { labelPlaces, type Spot, type Text, type Wanted } from "./label-places";
import type { Box, Layer, Placed, Scene } from "./layer";
import { markReach, movers, RADIUS, rankOf } from "./place";
import { radioBoxes } from "./radio-names";
import { scaleBox } from "./scale";

/** Of text of the usual size. */
const LINE_PX = 16;
const NAME_PX = 14;
const PADDING = 5;
const BESIDE_PX = 6;
const MOST_WIDTHS = 4000;
/** Of whose ellipse less than this share of its border is on the map, it is said in words how far off he may be: a
 * mark without a border around it looks like one that is sure. */
const BORDER_SEEN = 0.5;

const widths = new Map<string, number>();
let before: ReadonlyMap<string, Spot> = new Map();

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
    const drawn = laidOut(context, scene);
    context.save();
    context.font = fontOf(scene);
    context.textAlign = "left";
    context.textBaseline = "top";
    for (const { place, spot } of drawn) if (spot.led) lead(context, scene, place, spot.box);
    for (const { place, spot, words } of drawn)
      write(context, scene, place, linesOf(words, spot.text), spot.box);
    context.restore();
  },
};

/** What the labels of a scene take up. */
export function labelBoxes(context: CanvasRenderingContext2D, scene: Scene): Box[] {
  return laidOut(context, scene).map(({ spot }) => spot.box);
}

const laidOutOf = new WeakMap<Scene, readonly (Label & { readonly spot: Spot })[]>();

/** The labels that have a place, worked out once for a scene. */
function laidOut(context: CanvasRenderingContext2D, scene: Scene) {
  const known = laidOutOf.get(scene);
  if (known !== undefined) return known;
  context.save();
  context.font = fontOf(scene);
  const everybody = movers(scene);
  const marks: Box[] = everybody.flatMap(({ x, y, elsewhere }) =>
    elsewhere ? [] : [{ x: x - RADIUS, y: y - RADIUS, width: 2 * RADIUS, height: 2 * RADIUS }],
  );
  const labelled = everybody
    .reverse()
    .filter((place) => urgent(scene, place) || (!place.elsewhere && place.node.status !== "retired"))
    .map((place) => labelOf(context, scene, place));
  context.restore();
  const spots = labelPlaces(
    labelled.map(({ wanted }) => wanted),
    marks,
    [...scene.covered, scaleBox(scene.view)],
    scene.view,
    before,
    radioBoxes(scene),
  );
  before = spots;
  const laid = labelled.flatMap((label) => {
    const spot = spots.get(label.place.node.node);
    return spot === undefined ? [] : [{ ...label, spot }];
  });
  laidOutOf.set(scene, laid);
  return laid;
}

function fontOf(scene: Scene): string {
  return `600 ${NAME_PX * scene.view.text}px system-ui, sans-serif`;
}

interface Label {
  readonly place: Placed;
  readonly words: LabelWords;
  readonly wanted: Wanted;
}

function linesOf(words: LabelWords, text: Text): readonly string[] {
  return text === "whole" ? words.whole : [words[text]];
}

function labelOf(context: CanvasRenderingContext2D, scene: Scene, place: Placed): Label {
  const labelled = { ...scene, narrow: isNarrow(scene.view) };
  const words = labelWords(place.node, labelled, errorNotSeen(scene, place));
  const size = (text: Text) => {
    const lines = linesOf(words, text);
    return {
      width: Math.max(...lines.map((line) => widthOf(context, line))) + 2 * PADDING,
      height: lines.length * LINE_PX * scene.view.text + PADDING,
    };
  };
  const wanted = {
    node: place.node.node,
    x: place.x,
    y: place.y,
    away: markReach(scene, place.node) + BESIDE_PX,
    whole: size("whole"),
    short: size("short"),
    brief: size("brief"),
    always: urgent(scene, place),
    rank: rankOf(scene, place.node),
  };
  return { place, words, wanted };
}

/** How far off somebody may be (m), where the map is too small to show it. */
export function errorNotSeen(scene: Scene, { node }: Pick<Placed, "node">): number | null {
  const sighting = scene.picture?.nodes.get(node.node);
  const covariance = sighting && covarianceAt(sighting, scene.now);
  if (!covariance || node.position_m == null) return null;
  const seen = borderOnMap(scene.view, node.position_m, ellipseOf(covariance));
  return seen < BORDER_SEEN ? ce95(covariance) : null;
}

function urgent(scene: Scene, { node }: Placed): boolean {
  return node.node === scene.selected || scene.alarms.has(node.node);
}

/** A line from the edge of the mark to the nearest point of its label. */
function lead(context: CanvasRenderingContext2D, scene: Scene, { node, x, y }: Placed, box: Box): void {
  const [toX, toY] = nearest(box, x, y);
  const length = Math.hypot(toX - x, toY - y);
  const edge = Math.min(markReach(scene, node) / length, 1);
  context.strokeStyle = scene.palette.ink;
  context.lineWidth = 1.5;
  context.beginPath();
  context.moveTo(x + (toX - x) * edge, y + (toY - y) * edge);
  context.lineTo(toX, toY);
  context.stroke();
}

function write(
  context: CanvasRenderingContext2D,
  scene: Scene,
  { node }: Placed,
  lines: readonly string[],
  box: Box,
): void {
  const { palette } = scene;
  const alarm = scene.alarms.has(node.node);
  const low = isLowOnAir(node);
  context.globalAlpha = alarm || low ? 1 : 0.82;
  context.fillStyle = alarm ? palette.alarm : low ? palette.warn : palette.panel;
  context.beginPath();
  context.roundRect(box.x, box.y, box.width, box.height, 4);
  context.fill();
  context.globalAlpha = 1;
  lines.forEach((line, index) => {
    if (alarm) context.fillStyle = palette.alarmInk;
    else if (low) context.fillStyle = palette.panel;
    else context.fillStyle = index === 0 ? palette.ink : palette.inkSoft;
    context.fillText(line, box.x + PADDING, box.y + 3 + index * LINE_PX * scene.view.text);
  });
}
