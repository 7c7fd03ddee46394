/** Who lies under what covers the map. */
import type { PlacedNode } from "../domain/map/around";
import {
  type Bounds,
  fitted,
  fittedFreely,
  type Margins,
  marginsOf,
  toScreen,
  type View,
} from "../domain/map/view";
import type { Box } from "./layer";

/** A map that is fitted anew leaves so much between people and buttons (CSS pixels): who then takes a step towards one
 * does not have it fitted again. */
const CLEAR_PX = 60;
/** People are shown so much smaller at most that a UAV, to which the map is not fitted, lies under no button. */
const HARDLY_SMALLER = 0.8;

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

/** How bad it is what lies under a button: 2 where a mark of `nodes` does, 1 where one of those `beside`, else 0. */
export function coverage(
  nodes: readonly PlacedNode[],
  beside: readonly PlacedNode[],
  view: View,
  covered: readonly Box[],
  reach: number,
): number {
  if (isAnybodyCovered(nodes, view, covered, reach)) return 2;
  return isAnybodyCovered(beside, view, covered, reach) ? 1 : 0;
}

/**
 * The view that shows the bounds as large as can be with none of `nodes` under a button; with none of those `beside`
 * either, where that makes it hardly smaller.
 */
export function fittedClear(
  view: View,
  nodes: readonly PlacedNode[],
  beside: readonly PlacedNode[],
  bounds: Bounds,
  margins: readonly Margins[],
  covered: readonly Box[],
): View {
  const clearOf = (them: readonly PlacedNode[]) =>
    fittedFreely(view, bounds, margins, (fit) => !isAnybodyCovered(them, fit, covered, CLEAR_PX));
  const best = clearOf(nodes) ?? fitted(view, bounds, margins.at(-1) ?? marginsOf(view));
  const ofAll = clearOf([...nodes, ...beside]);
  return ofAll && ofAll.pixelsPerMetre >= HARDLY_SMALLER * best.pixelsPerMetre ? ofAll : best;
}
