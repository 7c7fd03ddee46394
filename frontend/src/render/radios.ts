/** What stands: base, anchors, beacons, breadcrumbs, each in its own shape. */
import { statusAt } from "../domain/staleness";
import type { Layer, Placed, Scene } from "./layer";
import { radios as standing } from "./place";

/** From this scale on breadcrumbs carry their names (pixels per metre). */
const NAMED_FROM = 14;
const NEAR_ENOUGH_TO_NAME = 40;
/** Width of a character of a name, about (px). */
const CHARACTER_PX = 7;
/** Names nearer to each other are read as one (px). */
const APART_PX = 8;
const LINE_PX = 14;

interface Name {
  readonly text: string;
  /** Its middle (CSS pixels). */
  readonly x: number;
  readonly y: number;
}

/** The names that have room: those that would lie over one before them are left out. The marks tell more than a smear. */
export function readable(names: readonly Name[], size = 1): Name[] {
  const kept: Name[] = [];
  const half = ({ text }: Name) => (text.length * CHARACTER_PX * size) / 2;
  for (const name of names) {
    const over = kept.some(
      (other) =>
        Math.abs(other.y - name.y) < LINE_PX * size &&
        Math.abs(other.x - name.x) < half(other) + half(name) + APART_PX,
    );
    if (!over) kept.push(name);
  }
  return kept;
}

export const radios: Layer = {
  draw(context, scene) {
    const all = standing(scene);
    context.save();
    for (const place of all) {
      context.globalAlpha = place.elsewhere ? 0.18 : place.node.status === "retired" ? 0.35 : 1;
      mark(context, scene, place);
    }
    if (scene.view.pixelsPerMetre >= NAMED_FROM || all.length <= NEAR_ENOUGH_TO_NAME) {
      context.font = `${12 * scene.view.text}px system-ui, sans-serif`;
      context.textAlign = "center";
      context.textBaseline = "top";
      context.globalAlpha = 1;
      context.fillStyle = scene.palette.inkSoft;
      const names = all.flatMap(({ node, x, y, elsewhere }) =>
        elsewhere ? [] : [{ text: words(scene, node), x, y: y + 9 }],
      );
      for (const { text, x, y } of readable(names, scene.view.text)) context.fillText(text, x, y);
    }
    context.restore();
  },
};

function words(scene: Scene, node: Placed["node"]): string {
  if (node.status === "retired") return `${node.node} gone`;
  if (node.moved) return `${node.node} MOVED`;
  return statusAt(node, scene.now, scene.limits) === "live" ? node.node : `${node.node} silent`;
}

function mark(context: CanvasRenderingContext2D, scene: Scene, { node, x, y }: Placed): void {
  const status = statusAt(node, scene.now, scene.limits);
  const colour = node.moved ? scene.palette.warn : scene.palette.radio;
  context.strokeStyle = context.fillStyle = colour;
  context.lineWidth = 2;
  context.setLineDash(status === "live" || status === "retired" ? [] : [2, 2]);
  context.beginPath();
  switch (node.role) {
    case "base":
      // A house with its mast: where everybody comes from, and back to.
      context.rect(x - 9, y - 6, 18, 13);
      context.moveTo(x, y - 6);
      context.lineTo(x, y - 15);
      context.moveTo(x - 4, y - 15);
      context.lineTo(x + 4, y - 15);
      context.stroke();
      break;
    case "anchor":
      context.moveTo(x, y - 8);
      context.lineTo(x + 8, y + 6);
      context.lineTo(x - 8, y + 6);
      context.closePath();
      context.fill();
      break;
    case "beacon":
      context.moveTo(x, y - 8);
      context.lineTo(x + 8, y + 6);
      context.lineTo(x - 8, y + 6);
      context.closePath();
      context.stroke();
      break;
    default:
      context.arc(x, y, 5, 0, 2 * Math.PI);
      if (status === "live") context.fill();
      else context.stroke();
  }
  if (node.status === "retired") {
    context.beginPath();
    context.moveTo(x - 7, y - 7);
    context.lineTo(x + 7, y + 7);
    context.moveTo(x + 7, y - 7);
    context.lineTo(x - 7, y + 7);
    context.stroke();
  }
  context.setLineDash([]);
}
