import { expect, test } from "vitest";
import { DEFAULT_LIMITS, whileUnheard } from "../fixes/staleness";
import { aNode, NOON, pictureWith } from "../samples";
import { lowAirInWords, lowOnAir } from "./air";

const LOW = { air_state: "low", air_t: NOON - 3 } as const;

test("whoever's air is low is told with pressure and age, the least first; the others are not", () => {
  const picture = pictureWith(
    aNode({ node: "ff1", callsign: "E7-1", air_bar: 170, air_state: "turn_back", air_t: NOON }),
    aNode({ node: "ff2", callsign: "E7-2", air_bar: 58, ...LOW }),
    aNode({ node: "ff3", callsign: null, air_bar: 40, ...LOW }),
    aNode({ node: "ff4", air_bar: 0, ...LOW, status: "retired" }),
  );
  expect(lowOnAir(picture, NOON, DEFAULT_LIMITS)).toEqual([
    { node: "ff3", name: "ff3", air: "40 bar", age_s: 3 },
    { node: "ff2", name: "E7-2", air: "58 bar", age_s: 3 },
  ]);
  expect(lowOnAir(null, NOON, DEFAULT_LIMITS)).toEqual([]);
});

test("air that is not heard of any more stays low, and was so then", () => {
  const picture = pictureWith(aNode({ air_bar: 50, ...LOW }));
  expect(lowOnAir(picture, NOON + 300, DEFAULT_LIMITS)).toMatchObject([{ air: "was 50 bar", age_s: 303 }]);
  expect(lowOnAir(picture, NOON, whileUnheard(DEFAULT_LIMITS))).toMatchObject([{ air: "was 50 bar" }]);
  const sensorSilent = pictureWith(aNode({ air_bar: 50, ...LOW, air_t: NOON - 300 }));
  expect(lowOnAir(sensorSilent, NOON, DEFAULT_LIMITS)).toMatchObject([{ air: "was 50 bar", age_s: 300 }]);
});

test("it is said again only when it is somebody else's", () => {
  const said = (bar: number) => {
    const picture = pictureWith(aNode({ air_bar: bar, ...LOW }));
    return lowAirInWords(lowOnAir(picture, NOON, DEFAULT_LIMITS));
  };
  expect(said(50)).toBe("Low air: E7-1.");
  expect(said(49)).toBe(said(50));
  expect(lowAirInWords([])).toBe("");
});
