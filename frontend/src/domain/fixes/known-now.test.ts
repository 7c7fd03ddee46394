import { describe, expect, test } from "vitest";
import { aNode, NOON, pictureWith, STOREYS } from "../samples";
import type { Track } from "../types";
import { knownNow, knownWords, pointAt } from "./known-now";

/** Somebody who walks to the east by a metre each second, on the ground floor or higher. */
function walk(node: string, seconds: readonly number[], up_m = 0): Track {
  return { node, points: seconds.map((s) => [NOON + s, s, 0, up_m, 0.01, 0, 0, 0.01, 0, 0.01]) };
}

describe("the place at a moment", () => {
  const track = walk("ff1", [0, 1, 2, 40, 41]);
  test("lies between the seconds before and after it", () => {
    expect(pointAt(track, NOON + 1.25)?.position).toEqual([1.25, 0, 0]);
    expect(pointAt(track, NOON + 2)?.position).toEqual([2, 0, 0]);
  });
  test("is not known before the first, in a gap, nor after the last", () => {
    expect([-1, 20, 43].map((s) => pointAt(track, NOON + s))).toEqual([null, null, null]);
    expect(pointAt(track, NOON + 41.5)?.position).toEqual([41, 0, 0]);
  });
});

describe("who was shown elsewhere than is known now", () => {
  const where = (node: ReturnType<typeof aNode>, up_m = 0, at_s = 3) => {
    const found = knownNow([walk("ff1", [0, 1, 2, 3, 4], up_m)], pictureWith(node), NOON + at_s, STOREYS);
    return found.get("ff1");
  };
  const words = (node: ReturnType<typeof aNode>, up_m = 0) => {
    const found = where(node, up_m);
    return found && knownWords(found, node, STOREYS);
  };

  test("is told how far, and whether outside of the ellipse that was shown", () => {
    const sure = aNode({ level: 0, level_p: 1, t: NOON + 3, covariance_m2: [1, 0, 0, 1, 0, 1] });
    expect(words(sure)).toBe("3.0 m off, outside the ellipse");
    expect(words({ ...sure, position_m: [1, 0, 0] })).toBe("2.0 m off");
    // A narrow ellipse that points north does not reach somebody to the east of it.
    expect(where({ ...sure, position_m: [1, 0, 0], covariance_m2: [0.2, 0, 0, 9, 0, 1] })?.outside).toBe(
      true,
    );
  });

  test("is told the storey where another one was shown, or none for sure", () => {
    const node = aNode({ position_m: [3, 0, 0], level: 0, level_p: 0.97, t: NOON + 3 });
    expect(words(node, 3.2)).toBe("0.0 m off, Level 1");
    expect(words(node)).toBe("0.0 m off");
    expect(words({ ...node, level_p: 0.6 })).toBe("0.0 m off, Level G");
  });

  test("is told also where nothing was shown yet", () => {
    expect(words(aNode({ position_m: null, covariance_m2: null }))).toBe("not shown then");
  });

  test("is nobody who stands, nor whom the picture does not have", () => {
    expect(where(aNode({ role: "breadcrumb" }))).toBeUndefined();
    expect(where(aNode({ node: "ff2" }))).toBeUndefined();
  });
});
