/** How long a metre is, and where north is. */
import { isNarrow, type View } from "../domain/map/view";
import type { Box, Layer } from "./layer";

const LONGEST_PX = 160;
const LENGTHS = [1, 2, 5, 10, 20, 50, 100, 200, 500, 1000, 2000, 5000];
const MARGIN = 16;
/** On a phone's map the buttons lie in a row at its foot; one that is lower than this has no room for a scale. */
const ABOVE_BUTTONS_PX = 50;
const LEAST_HEIGHT_PX = 220;
const HEIGHT_PX = 30;
/** From the end of the bar to the middle of the arrow, and on to the end of its letter. */
const TO_NORTH_PX = 28;
const NORTH_PX = 24;

function lengthOf({ pixelsPerMetre }: View): number {
  return LENGTHS.filter((metres) => metres * pixelsPerMetre <= LONGEST_PX).at(-1) ?? 1;
}

function footOf(view: View): number {
  return isNarrow(view) ? MARGIN + ABOVE_BUTTONS_PX : MARGIN;
}

function hasRoom(view: View): boolean {
  return !isNarrow(view) || view.height >= LEAST_HEIGHT_PX;
}

/** What it takes up of a map. */
export function scaleBox(view: View): Box {
  if (!hasRoom(view)) return { x: 0, y: view.height, width: 0, height: 0 };
  const width = MARGIN + lengthOf(view) * view.pixelsPerMetre + TO_NORTH_PX + NORTH_PX * view.text;
  const height = footOf(view) + HEIGHT_PX * view.text;
  return { x: 0, y: view.height - height, width, height };
}

export const scale: Layer = {
  draw(context, { view, palette }) {
    if (!hasRoom(view)) return;
    const length = lengthOf(view);
    const width = length * view.pixelsPerMetre;
    const y = view.height - footOf(view);
    context.save();
    context.strokeStyle = context.fillStyle = palette.inkSoft;
    context.lineWidth = 2;
    context.beginPath();
    context.moveTo(MARGIN, y - 6);
    context.lineTo(MARGIN, y);
    context.lineTo(MARGIN + width, y);
    context.lineTo(MARGIN + width, y - 6);
    context.stroke();
    context.font = `600 ${13 * view.text}px system-ui, sans-serif`;
    context.textAlign = "left";
    context.textBaseline = "bottom";
    context.fillText(`${length} m`, MARGIN + 6, y - 4);
    const north = MARGIN + width + TO_NORTH_PX;
    context.beginPath();
    context.moveTo(north, y - 22);
    context.lineTo(north + 7, y);
    context.lineTo(north, y - 6);
    context.lineTo(north - 7, y);
    context.closePath();
    context.fill();
    context.fillText("N", north + 11, y + 2);
    context.restore();
  },
};
