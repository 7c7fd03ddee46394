/** The ground: a grid of local metres. */
import { toLocal, toScreen } from "../domain/map/view";
import type { Layer } from "./layer";

const LEAST_CELL_PX = 34;
const STEPS = [1, 2, 5, 10, 20, 50, 100, 200, 500, 1000, 2000, 5000];

/** Metres between grid lines at a scale. */
export function gridStep(pixelsPerMetre: number): number {
  return STEPS.find((step) => step * pixelsPerMetre >= LEAST_CELL_PX) ?? 10_000;
}

export const grid: Layer = {
  draw(context, { view, palette }) {
    context.fillStyle = palette.ground;
    context.fillRect(0, 0, view.width, view.height);
    const step = gridStep(view.pixelsPerMetre);
    const [west, north] = toLocal(view, 0, 0);
    const [east, south] = toLocal(view, view.width, view.height);
    for (const strong of [false, true]) {
      context.beginPath();
      for (let e = Math.ceil(west / step) * step; e <= east; e += step) {
        if ((Math.round(e / step) % 5 === 0) !== strong) continue;
        const x = Math.round(toScreen(view, e, 0)[0]) + 0.5;
        context.moveTo(x, 0);
        context.lineTo(x, view.height);
      }
      for (let n = Math.ceil(south / step) * step; n <= north; n += step) {
        if ((Math.round(n / step) % 5 === 0) !== strong) continue;
        const y = Math.round(toScreen(view, 0, n)[1]) + 0.5;
        context.moveTo(0, y);
        context.lineTo(view.width, y);
      }
      context.strokeStyle = strong ? palette.gridStrong : palette.grid;
      context.lineWidth = 1;
      context.stroke();
    }
  },
};
