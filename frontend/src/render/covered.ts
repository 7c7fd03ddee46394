/** Who lies under what covers the map. */
import type { PlacedNode } from "../domain/around";
import { fittedFreely, type Margins, toScreen, type View } from "../domain/view";
import type { Box } from "./layer";

/** A map that is fitted anew leaves so much between people and buttons (CSS pixels): who then takes a step towards one
 * does not have it fitted again. */
const CLEAR_PX = 60;

/** Whether something lies over a mark there (CSS pixels) that reaches so far. */
export function isCovered(
  covered: readonly Box[],
  [x, y]: readonly [number, number],
  reach: number,
): boolean {
  return covered.some(
    (box) =>
      box.height > 0 &&
      x > box.x - reach &&
      y > box.y - reach &&
      x < box.x + box.width + reach &&
      y < box.y + box.height + reach,
  );
}

/** Whether something lies over anybody's mark. */
export function isAnybodyCovered(
  nodes: readonly PlacedNode[],
  view: View,
  covered: readonly Box[],
  reach: number,
): boolean {
  return nodes.some(({ position_m: [e, n] }) => isCovered(covered, toScreen(view, e, n), reach));
}

/** The view that shows nodes, and the bounds around them, as large as can be with nobody under a button. */
export function fittedClear(
  view: View,
  nodes: readonly PlacedNode[],
  bounds: Parameters<typeof fittedFreely>[1],
  margins: readonly Margins[],
  covered: readonly Box[],
): View {
  return fittedFreely(view, bounds, margins, (fit) => !isAnybodyCovered(nodes, fit, covered, CLEAR_PX));
}
