/** What each key does. */

export type Act =
  | { do: "playPause" }
  | { do: "step"; seconds: number }
  | { do: "faster" | "slower" }
  | { do: "compare" }
  | { do: "backToLive" }
  | { do: "zoom"; factor: number }
  | { do: "pan"; dx: number; dy: number }
  | { do: "fit" }
  | { do: "level"; step: 1 | -1 }
  | { do: "allLevels" }
  | { do: "select"; step: 1 | -1 }
  | { do: "theme" }
  | { do: "help" }
  | { do: "close" };

export interface KeyPress {
  readonly key: string;
  readonly shiftKey: boolean;
  readonly ctrlKey: boolean;
  readonly altKey: boolean;
  readonly metaKey: boolean;
}

const PAN_PIXELS = 80;
export const ZOOM_STEP = 1.4;

const KEYS: Record<string, Act> = {
  " ": { do: "playPause" },
  ArrowLeft: { do: "step", seconds: -1 },
  ArrowRight: { do: "step", seconds: 1 },
  ArrowUp: { do: "faster" },
  ArrowDown: { do: "slower" },
  j: { do: "step", seconds: -10 },
  l: { do: "step", seconds: 10 },
  k: { do: "compare" },
  b: { do: "backToLive" },
  "+": { do: "zoom", factor: ZOOM_STEP },
  "=": { do: "zoom", factor: ZOOM_STEP },
  "-": { do: "zoom", factor: 1 / ZOOM_STEP },
  f: { do: "fit" },
  PageUp: { do: "level", step: 1 },
  PageDown: { do: "level", step: -1 },
  a: { do: "allLevels" },
  n: { do: "select", step: 1 },
  p: { do: "select", step: -1 },
  t: { do: "theme" },
  "?": { do: "help" },
  Escape: { do: "close" },
};

const SHIFTED: Record<string, Act> = {
  ArrowLeft: { do: "pan", dx: PAN_PIXELS, dy: 0 },
  ArrowRight: { do: "pan", dx: -PAN_PIXELS, dy: 0 },
  ArrowUp: { do: "pan", dx: 0, dy: PAN_PIXELS },
  ArrowDown: { do: "pan", dx: 0, dy: -PAN_PIXELS },
};

/**
 * What a key press asks for; null where it is the browser's. With `letters` off, single characters
 * do nothing (WCAG 2.1.4), so that speech input or a heavy glove sets nothing off.
 */
export function actOf(press: KeyPress, letters: boolean): Act | null {
  if (press.ctrlKey || press.altKey || press.metaKey) return null;
  if (press.shiftKey && press.key in SHIFTED) return SHIFTED[press.key] ?? null;
  if (!letters && press.key.length === 1) return null;
  const key = press.key.length === 1 ? press.key.toLowerCase() : press.key;
  return KEYS[key] ?? null;
}

/** The help sheet: keys, and what they do. */
export const KEY_HELP: readonly (readonly [keys: string, does: string])[] = [
  ["Space", "Play or pause; from live: pause here"],
  ["← →", "1 s back, 1 s on"],
  ["J L", "10 s back, 10 s on"],
  ["↑ ↓", "Faster, slower"],
  ["K", "In a replay: beside what was shown then, what is known now"],
  ["B", "Back to live"],
  ["+ −", "Zoom in, zoom out"],
  ["Shift + arrows", "Move the map"],
  ["F", "Fit everyone into the map"],
  ["Page ↑ ↓", "Storey above, storey below"],
  ["A", "All storeys"],
  ["N P", "Next, previous responder"],
  ["T", "Day, dusk, night"],
  ["Esc", "Close, deselect"],
  ["?", "This sheet"],
];
