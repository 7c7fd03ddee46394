/** How long a metre is, and where north is. */
import type { Layer } from "./layer";

const LONGEST_PX = 160;
const LENGTHS = [1, 2, 5, 10, 20, 50, 100, 200, 500, 1000, 2000, 5000];
const MARGIN = 16;

export const scale: Layer = {
  draw(context, { view, palette }) {
    const length = LENGTHS.filter((metres) => metres * view.pixelsPerMetre <= LONGEST_PX).at(-1) ?? 1;
    const width = length * view.pixelsPerMetre;
    const y = view.height - MARGIN;
    context.save();
    context.strokeStyle = context.fillStyle = palette.inkSoft;
    context.lineWidth = 2;
    context.beginPath();
    context.moveTo(MARGIN, y - 6);
    context.lineTo(MARGIN, y);
    context.lineTo(MARGIN + width, y);
    context.lineTo(MARGIN + width, y - 6);
    context.stroke();
    context.font = "600 13px system-ui, sans-serif";
    context.textAlign = "left";
    context.textBaseline = "bottom";
    context.fillText(`${length} m`, MARGIN + 6, y - 4);
    const north = MARGIN + width + 28;
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
