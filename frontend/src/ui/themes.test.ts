import { describe, expect, test } from "vitest";
import { contrast, luminance } from "../domain/contrast";
import { crewMarks, markOf } from "../domain/people/crews";
import { aNode } from "../domain/samples";
import { PALETTES, THEMES } from "./themes";

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

  test("the ellipse, the trail and the lost mark of every crew, and of who has none, are told from what they lie on", () => {
    const people = ["1", "2", "3", "4", "5", "6", null].map((crew) => aNode({ crew }));
    const marks = people.map((node) => markOf(node, crewMarks(people)));
    for (const ground of [palette.ground, palette.panel, palette.raised]) {
      for (const { line } of marks) expect(contrast(ground, line[palette.shade])).toBeGreaterThanOrEqual(3);
    }
  });
});

test("by night what is chosen, which stays on the screen, shines no more than an alarm", () => {
  expect(luminance(PALETTES.night.chosen)).toBeLessThan(luminance(PALETTES.night.alarm));
});
