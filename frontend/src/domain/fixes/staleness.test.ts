import { describe, expect, test } from "vitest";
import { aNode, anIncident, NOON } from "../samples";
import { ageS, covarianceAt, DEFAULT_LIMITS, limitsOf, statusAt, whileUnheard } from "./staleness";

describe("the status of a fix", () => {
  test.each([
    [0, "live"],
    [10, "live"],
    [10.1, "stale"],
    [60, "stale"],
    [60.1, "lost"],
  ] as const)("of a responder %d s old is %s", (age, status) => {
    expect(statusAt(aNode(), NOON + age, DEFAULT_LIMITS)).toBe(status);
  });

  test.each([
    [60, "live"],
    [61, "stale"],
    [301, "lost"],
  ] as const)("of a breadcrumb %d s old is %s", (age, status) => {
    expect(statusAt(aNode({ role: "breadcrumb" }), NOON + age, DEFAULT_LIMITS)).toBe(status);
  });

  test("is never better than the server says", () => {
    expect(statusAt(aNode({ status: "lost" }), NOON, DEFAULT_LIMITS)).toBe("lost");
  });

  test("of the base and of who has left does not age", () => {
    expect(statusAt(aNode({ role: "base" }), NOON + 9999, DEFAULT_LIMITS)).toBe("live");
    expect(statusAt(aNode({ status: "retired" }), NOON + 9999, DEFAULT_LIMITS)).toBe("retired");
  });

  test("follows the limits of the incident", () => {
    const limits = limitsOf(anIncident({ settings: { stale_after_s: 3 } }));
    expect(statusAt(aNode(), NOON + 4, limits)).toBe("stale");
    expect(limits.lostAfterS).toBe(DEFAULT_LIMITS.lostAfterS);
  });
});

test("while the server is not heard no responder is live, however new the fix; who is lost stays lost", () => {
  const limits = whileUnheard(DEFAULT_LIMITS);
  expect(statusAt(aNode(), NOON, limits)).toBe("stale");
  expect(statusAt(aNode(), NOON + 61, limits)).toBe("lost");
  expect(statusAt(aNode({ status: "retired" }), NOON, limits)).toBe("retired");
  expect(statusAt(aNode({ role: "breadcrumb" }), NOON, limits)).toBe("live");
});

test("an age is never negative, however the clocks differ", () => {
  expect(ageS(aNode({ t: NOON + 2 }), NOON)).toBe(0);
});

describe("the uncertainty of a fix", () => {
  const fresh = { state: aNode(), presentedT: NOON };

  test("grows by 0.5 m a second on the ground and 0.1 m a second in height once it is a second old", () => {
    expect(covarianceAt(fresh, NOON + 0.9)).toEqual([1, 0, 0, 1, 0, 1]);
    const grown = covarianceAt(fresh, NOON + 10);
    expect(grown?.[0]).toBeCloseTo(1 + 25);
    expect(grown?.[3]).toBeCloseTo(1 + 25);
    expect(grown?.[5]).toBeCloseTo(1 + 1);
  });

  test("counts only the growth that the server has not put in already", () => {
    const presentedOld = { state: aNode(), presentedT: NOON + 10 };
    expect(covarianceAt(presentedOld, NOON + 10)?.[0]).toBe(1);
    expect(covarianceAt(presentedOld, NOON + 20)?.[0]).toBeCloseTo(1 + 0.25 * (400 - 100));
  });

  test("of what stands does not grow, and of no fix is none", () => {
    const crumb = { state: aNode({ role: "breadcrumb" }), presentedT: NOON };
    expect(covarianceAt(crumb, NOON + 500)).toEqual([1, 0, 0, 1, 0, 1]);
    expect(covarianceAt({ state: aNode({ covariance_m2: null }), presentedT: NOON }, NOON)).toBeNull();
  });
});
