/** From local metres to pixels of the map and back. North is up; the view never turns. */
import type { Position } from "../types";

export interface View {
  /** Local position in the middle of the map (m). */
  readonly east_m: number;
  readonly north_m: number;
  readonly pixelsPerMetre: number;
  /** Size of the map (CSS pixels). */
  readonly width: number;
  readonly height: number;
  /** How many times the usual size text has: as the browser's own is set. */
  readonly text: number;
}

export interface Bounds {
  readonly west_m: number;
  readonly east_m: number;
  readonly south_m: number;
  readonly north_m: number;
}

/** Room kept free at the edges of the map when fitting (CSS pixels). */
export interface Margins {
  readonly left: number;
  readonly right: number;
  readonly top: number;
  readonly bottom: number;
}

/** For the storey buttons, the controls and the labels. */
const FULL_MARGINS: Margins = { left: 200, right: 210, top: 60, bottom: 70 };
/** Where no button lies beside who is on the map, room is kept for the labels alone (CSS pixels). */
const LABELS_BESIDE = { left: 70, right: 130 };
/** On a map less wide than this the margins are narrower too. */
const WIDE_ENOUGH_PX = 700;
/** On a phone the buttons lie over the head and the foot of the map, and nothing at its sides. */
const NARROW_PX = 520;
const NARROW_MARGINS: Margins = { left: 45, right: 75, top: 85, bottom: 100 };

/** A phone's map. */
export function isNarrow({ width, text }: Pick<View, "width" | "text">): boolean {
  return width <= NARROW_PX * text;
}

/** The margins that a map of this size keeps free. */
export function marginsOf({ width, text }: Pick<View, "width" | "text">): Margins {
  if (isNarrow({ width, text })) return NARROW_MARGINS;
  const share = Math.min(1, width / WIDE_ENOUGH_PX);
  return { ...FULL_MARGINS, left: FULL_MARGINS.left * share, right: FULL_MARGINS.right * share };
}

/** The margins that a fit may do with, where nobody comes to lie under a button: `usual`, and narrower at the sides. */
export function narrowerMargins(view: Pick<View, "width" | "text">, usual: Margins): readonly Margins[] {
  if (isNarrow(view)) return [usual];
  const [left, right] = [
    Math.min(usual.left, LABELS_BESIDE.left),
    Math.min(usual.right, LABELS_BESIDE.right),
  ];
  return [{ ...usual, left, right }, { ...usual, left }, { ...usual, right }, usual];
}

export const MIN_PIXELS_PER_METRE = 0.02;
export const MAX_PIXELS_PER_METRE = 400;
/** Fitting never shows less than this (m): one responder alone is no reason to fill the map with a dot. */
export const LEAST_SPAN_M = 12;

export const FIRST_VIEW: View = { east_m: 0, north_m: 0, pixelsPerMetre: 12, width: 1, height: 1, text: 1 };

export function toScreen(view: View, e_m: number, n_m: number): [x: number, y: number] {
  return [
    view.width / 2 + (e_m - view.east_m) * view.pixelsPerMetre,
    view.height / 2 - (n_m - view.north_m) * view.pixelsPerMetre,
  ];
}

export function toLocal(view: View, x: number, y: number): [e_m: number, n_m: number] {
  return [
    view.east_m + (x - view.width / 2) / view.pixelsPerMetre,
    view.north_m - (y - view.height / 2) / view.pixelsPerMetre,
  ];
}

/** Drags the map by pixels: what was under the finger stays under it. */
export function pan(view: View, dx: number, dy: number): View {
  return {
    ...view,
    east_m: view.east_m - dx / view.pixelsPerMetre,
    north_m: view.north_m + dy / view.pixelsPerMetre,
  };
}

/** Zooms by a factor; the place under pixel (x, y) stays there. */
export function zoomAbout(view: View, factor: number, x: number, y: number): View {
  const pixelsPerMetre = clampScale(view.pixelsPerMetre * factor);
  const [e_m, n_m] = toLocal(view, x, y);
  return {
    ...view,
    pixelsPerMetre,
    east_m: e_m - (x - view.width / 2) / pixelsPerMetre,
    north_m: n_m + (y - view.height / 2) / pixelsPerMetre,
  };
}

type Pixel = readonly [x: number, y: number];

/** Two fingers: the places under both stay under them (pan and zoom at once, no turn). */
export function pinch(view: View, before: readonly [Pixel, Pixel], after: readonly [Pixel, Pixel]): View {
  const middle = ([[ax, ay], [bx, by]]: readonly [Pixel, Pixel]) => [(ax + bx) / 2, (ay + by) / 2] as const;
  const span = ([[ax, ay], [bx, by]]: readonly [Pixel, Pixel]) => Math.max(1, Math.hypot(ax - bx, ay - by));
  const [x0, y0] = middle(before);
  const [x1, y1] = middle(after);
  return pan(zoomAbout(view, span(after) / span(before), x0, y0), x1 - x0, y1 - y0);
}

export function resize(view: View, width: number, height: number): View {
  return { ...view, width: Math.max(1, width), height: Math.max(1, height) };
}

/** The smallest box around the positions; null where there are none. */
export function boundsOf(positions: Iterable<Position>): Bounds | null {
  let bounds: Bounds | null = null;
  for (const [e, n] of positions) {
    bounds =
      bounds === null
        ? { west_m: e, east_m: e, south_m: n, north_m: n }
        : {
            west_m: Math.min(bounds.west_m, e),
            east_m: Math.max(bounds.east_m, e),
            south_m: Math.min(bounds.south_m, n),
            north_m: Math.max(bounds.north_m, n),
          };
  }
  return bounds;
}

/** The view that shows the bounds inside the margins. */
export function fitted(view: View, bounds: Bounds, margins: Margins): View {
  const width = Math.max(50, view.width - margins.left - margins.right);
  const height = Math.max(50, view.height - margins.top - margins.bottom);
  const spanE_m = Math.max(LEAST_SPAN_M, bounds.east_m - bounds.west_m);
  const spanN_m = Math.max(LEAST_SPAN_M, bounds.north_m - bounds.south_m);
  const pixelsPerMetre = clampScale(Math.min(width / spanE_m, height / spanN_m));
  const centred: View = {
    ...view,
    pixelsPerMetre,
    east_m: (bounds.west_m + bounds.east_m) / 2,
    north_m: (bounds.south_m + bounds.north_m) / 2,
  };
  return pan(centred, (margins.left - margins.right) / 2, (margins.top - margins.bottom) / 2);
}

/** How far from the middle a fit may lie, as a share of the room that its bounds leave between the margins. */
const ASIDE = [0, -0.25, 0.25, -0.5, 0.5];

/** The fit within margins, then the same moved to where its bounds are inside of them as well, the least moved first. */
function fitsWithin(view: View, bounds: Bounds, margins: Margins): View[] {
  const fit = fitted(view, bounds, margins);
  const room = (whole: number, edges: number, span_m: number) =>
    Math.max(0, whole - edges - span_m * fit.pixelsPerMetre);
  const x = room(view.width, margins.left + margins.right, bounds.east_m - bounds.west_m);
  const y = room(view.height, margins.top + margins.bottom, bounds.north_m - bounds.south_m);
  return ASIDE.flatMap((share) => (share === 0 ? [fit] : [pan(fit, 0, share * y), pan(fit, share * x, 0)]));
}

/**
 * The largest of the fits within one of the margins that is `free`, as near to the middle as it can lie; null where
 * none is.
 */
export function fittedFreely(
  view: View,
  bounds: Bounds,
  margins: readonly Margins[],
  free: (fit: View) => boolean,
): View | null {
  return (
    margins
      .flatMap((room) => fitsWithin(view, bounds, room))
      .sort((a, b) => b.pixelsPerMetre - a.pixelsPerMetre)
      .find(free) ?? null
  );
}

/**
 * Whether the bounds lie inside the margins and fill a fair part of them: then a fit can wait.
 * A fit to more than must be seen, `whole`, is not taken for one that is too wide: one is that shows much less
 * than `best`.
 */
export function fitsWell(
  view: View,
  bounds: Bounds,
  margins: Margins,
  whole: Bounds = bounds,
  best: View = fitted(view, whole, margins),
): boolean {
  const [left, bottom] = toScreen(view, bounds.west_m, bounds.south_m);
  const [right, top] = toScreen(view, bounds.east_m, bounds.north_m);
  const inside =
    left >= margins.left / 2 &&
    right <= view.width - margins.right / 2 &&
    top >= margins.top / 2 &&
    bottom <= view.height - margins.bottom / 2;
  return inside && view.pixelsPerMetre > best.pixelsPerMetre * 0.6;
}

/** Moves the view so that a place lies in the middle between the margins; unchanged where it lies inside already. */
export function bringIntoView(view: View, e_m: number, n_m: number, margins: Margins): View {
  const [x, y] = toScreen(view, e_m, n_m);
  const inside =
    x >= margins.left &&
    x <= view.width - margins.right &&
    y >= margins.top &&
    y <= view.height - margins.bottom;
  if (inside) return view;
  const centred = { ...view, east_m: e_m, north_m: n_m };
  return pan(centred, (margins.left - margins.right) / 2, (margins.top - margins.bottom) / 2);
}

function clampScale(pixelsPerMetre: number): number {
  return Math.min(MAX_PIXELS_PER_METRE, Math.max(MIN_PIXELS_PER_METRE, pixelsPerMetre));
}
