/** What stands: base, anchors, beacons, breadcrumbs, each in its own shape. */
import { statusAt } from "../domain/fixes/staleness";
import { overlap } from "./boxes";
import { labelBoxes } from "./labels";
import type { Layer, Placed, Scene } from "./layer";
import { radios as standing } from "./place";
import { boxOf, radioNames } from "./radio-names";

export const radios: Layer = {
  draw(context, scene) {
    const all = standing(scene);
    context.save();
    for (const place of all) {
      context.globalAlpha = place.elsewhere ? 0.18 : place.node.status === "retired" ? 0.35 : 1;
      mark(context, scene, place);
    }
    // Before the responders, whose marks lie on top; a name that a label would be written over is a smear.
    const labelled = labelBoxes(context, scene);
    context.font = `${12 * scene.view.text}px system-ui, sans-serif`;
    context.textAlign = "center";
    context.textBaseline = "top";
    context.globalAlpha = 1;
    context.fillStyle = scene.palette.inkSoft;
    for (const name of radioNames(scene)) {
      const box = boxOf(name, scene.view.text);
      if (!labelled.some((label) => overlap(label, box))) context.fillText(name.text, name.x, name.y);
    }
    context.restore();
  },
};

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
