/** What the style sheets take for the usual size of text (CSS pixels). */
const USUAL_PX = 16;

/** How many times the usual size text has on this page: as it is set in the browser. */
export function textSize(): number {
  return Number.parseFloat(getComputedStyle(document.documentElement).fontSize) / USUAL_PX;
}
