import { expect, test } from "vitest";
import { NOON } from "../domain/samples";
import type { Advice, Evidence } from "../domain/types";
import { Why } from "./why.svelte";

const EVIDENCE: Evidence = {
  node: "ff1",
  t: NOON,
  position_m: [0, 0, 0],
  covariance_m2: [1, 0, 0, 1, 0, 1],
  held: [],
  rejected: [],
  rest: 1,
};
const ADVICE: Advice = { node: "ff1", t: NOON, sigma_m: 3, suggestions: [] };

/** Answers that come when a test has them come. */
function answers<T>() {
  const asked: { resolve: (answer: T) => void; reject: (cause: Error) => void }[] = [];
  return {
    asked,
    ask: () => new Promise<T>((resolve, reject) => asked.push({ resolve, reject })),
  };
}

test("opening asks for the evidence, then for advice", async () => {
  const evidence = answers<Evidence>();
  const advice = answers<Advice>();
  const why = new Why({ evidence: evidence.ask, advice: advice.ask });
  const done = why.toggle();
  expect([why.open, why.busy, advice.asked.length]).toEqual([true, true, 0]);
  evidence.asked[0]?.resolve(EVIDENCE);
  await Promise.resolve();
  advice.asked[0]?.resolve(ADVICE);
  await done;
  expect([why.evidence, why.advice, why.busy, why.trouble]).toEqual([EVIDENCE, ADVICE, false, null]);
});

test("a refusal is said, and no advice is asked for", async () => {
  const advice = answers<Advice>();
  const why = new Why({
    evidence: () => Promise.reject(new Error("The position of 'ff1' is not decided yet.")),
    advice: advice.ask,
  });
  await why.toggle();
  expect([why.busy, why.trouble]).toEqual([false, "The position of 'ff1' is not decided yet."]);
  expect(advice.asked).toEqual([]);
});

test("without advice the evidence still stands", async () => {
  const why = new Why({
    evidence: () => Promise.resolve(EVIDENCE),
    advice: () => Promise.reject(new Error("Other sums are in the way.")),
  });
  await why.toggle();
  expect([why.evidence, why.trouble, why.noAdvice]).toEqual([EVIDENCE, null, "Other sums are in the way."]);
});

test("of the past there is evidence, and no advice", async () => {
  const why = new Why({ evidence: () => Promise.resolve(EVIDENCE), advice: () => null });
  await why.toggle();
  expect([why.evidence, why.advice, why.noAdvice]).toEqual([EVIDENCE, null, null]);
});

test("an answer that comes after the next question is not shown", async () => {
  const evidence = answers<Evidence>();
  const why = new Why({ evidence: evidence.ask, advice: () => null });
  const first = why.ask();
  const second = why.ask();
  evidence.asked[1]?.resolve({ ...EVIDENCE, t: NOON + 1 });
  await second;
  evidence.asked[0]?.resolve(EVIDENCE);
  await first;
  expect(why.evidence?.t).toBe(NOON + 1);
});

test("an answer that comes after closing is not shown", async () => {
  const evidence = answers<Evidence>();
  const why = new Why({ evidence: evidence.ask, advice: () => null });
  const done = why.toggle();
  await why.toggle();
  evidence.asked[0]?.reject(new Error("too late"));
  await done;
  expect([why.open, why.busy, why.evidence, why.trouble]).toEqual([false, false, null, null]);
});
