import { describe, expect, test } from "vitest";
import { PALETTES, THEMES } from "./themes";

/** Relative luminance of "#rrggbb" (WCAG 2.2). */
function luminance(colour: string): number {
  const [r = 0, g = 0, b = 0] = [1, 3, 5].map((at) => {
    const value = Number.parseInt(colour.slice(at, at + 2), 16) / 255;
    return value <= 0.04045 ? value / 12.92 : ((value + 0.055) / 1.055) ** 2.4;
  });
  return 0.2126 * r + 0.7152 * g + 0.0722 * b;
}

function contrast(a: string, b: string): number {
  const [dark = 0, light = 0] = [luminance(a), luminance(b)].sort((x, y) => x - y);
  return (light + 0.05) / (dark + 0.05);
}

describe.each(THEMES)("by %s", (theme) => {
  const palette = PALETTES[theme];

  test.each([
    ["chosen", "chosenInk"],
    ["accent", "accentInk"],
    ["alarm", "alarmInk"],
    ["panel", "inkSoft"],
    ["raised", "warn"],
  ] as const)("what is written on %s in %s can be read", (ground, ink) => {
    expect(contrast(palette[ground], palette[ink])).toBeGreaterThanOrEqual(4.5);
  });
});

test("by night what is chosen, which stays on the screen, shines no more than an alarm", () => {
  expect(luminance(PALETTES.night.chosen)).toBeLessThan(luminance(PALETTES.night.alarm));
});
