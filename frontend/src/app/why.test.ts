import { expect, test, vi } from "vitest";
import { NOON } from "../domain/samples";
import type { Advice, Evidence } from "../domain/types";
import type { Why, WhySource } from "./why.svelte";

vi.stubGlobal("window", { location: { origin: "http://screen" } });
const { RequestFailed } = await import("../sources/api");
const why = await import("./why.svelte");

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

const UNASKED = () => Promise.reject(new Error("Nobody should have asked."));
const slow = () => Promise.reject(new RequestFailed(504, "It takes longer than 60 s; it goes on."));

/** Of now, with advice, asking again at once, but for what a test says. */
function aWhy(source: Partial<WhySource>): Why {
  const all = { moment: () => null, evidence: UNASKED, advises: () => true, advice: UNASKED, ...source };
  return new why.Why(all, 0);
}

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
  const here = aWhy({ evidence: evidence.ask, advice: advice.ask });
  const done = here.toggle();
  expect([here.open, here.busy, advice.asked.length]).toEqual([true, true, 0]);
  evidence.asked[0]?.resolve(EVIDENCE);
  await vi.waitFor(() => expect(advice.asked.length).toBe(1));
  expect([here.busy, here.weighing]).toEqual([false, "advice"]);
  advice.asked[0]?.resolve(ADVICE);
  await done;
  expect([here.evidence, here.advice, here.busy, here.trouble]).toEqual([EVIDENCE, ADVICE, false, null]);
});

test("a refusal is said, and no advice is asked for", async () => {
  const advice = answers<Advice>();
  const here = aWhy({
    evidence: () => Promise.reject(new Error("The position of 'ff1' is not decided yet.")),
    advice: advice.ask,
  });
  await here.toggle();
  expect([here.busy, here.trouble]).toEqual([false, "The position of 'ff1' is not decided yet."]);
  expect(advice.asked).toEqual([]);
});

test("without advice the evidence still stands", async () => {
  const here = aWhy({
    evidence: () => Promise.resolve(EVIDENCE),
    advice: () => Promise.reject(new Error("Other sums are in the way.")),
  });
  await here.toggle();
  expect([here.evidence, here.trouble, here.noAdvice]).toEqual([
    EVIDENCE,
    null,
    "Other sums are in the way.",
  ]);
});

test("of the past there is evidence, and no advice", async () => {
  const here = aWhy({ evidence: () => Promise.resolve(EVIDENCE), advises: () => false });
  await here.toggle();
  expect([here.evidence, here.advice, here.noAdvice]).toEqual([EVIDENCE, null, null]);
});

test("an answer that comes after the next question is not shown", async () => {
  const evidence = answers<Evidence>();
  const here = aWhy({ evidence: evidence.ask, advises: () => false });
  const first = here.ask();
  const second = here.ask();
  evidence.asked[1]?.resolve({ ...EVIDENCE, t: NOON + 1 });
  await second;
  evidence.asked[0]?.resolve(EVIDENCE);
  await first;
  expect(here.evidence?.t).toBe(NOON + 1);
});

test("an answer that comes after closing is not shown", async () => {
  const evidence = answers<Evidence>();
  const here = aWhy({ evidence: evidence.ask, advises: () => false });
  const done = here.toggle();
  await here.toggle();
  evidence.asked[0]?.reject(new Error("too late"));
  await done;
  expect([here.open, here.busy, here.evidence, here.trouble]).toEqual([false, false, null, null]);
});

test("what the server takes long for is asked for until it is done, as one question about one moment", async () => {
  let now = NOON;
  const asked: (number | null)[] = [];
  const here = aWhy({
    moment: () => now++,
    evidence: (moment) => {
      asked.push(moment);
      return asked.length < 3 ? slow() : Promise.resolve(EVIDENCE);
    },
    advises: () => false,
  });
  await here.ask();
  expect([here.evidence, here.trouble, here.weighing]).toEqual([EVIDENCE, null, null]);
  expect(asked).toEqual([NOON, NOON, NOON]);
});

test("advice that takes long is waited for as well, under its evidence", async () => {
  const answers = [slow, slow, () => Promise.resolve(ADVICE)];
  const here = aWhy({
    evidence: () => Promise.resolve(EVIDENCE),
    advice: () => answers.shift()?.() ?? UNASKED(),
  });
  await here.ask();
  expect([here.evidence, here.advice, here.noAdvice]).toEqual([EVIDENCE, ADVICE, null]);
});

test("who closes it does not go on asking", async () => {
  let asked = 0;
  const here = aWhy({
    evidence: () => {
      asked += 1;
      here.close();
      return slow();
    },
  });
  await here.ask();
  expect([asked, here.open, here.weighing, here.trouble]).toEqual([1, false, null, null]);
});

test("it is known since when the answer is waited for", async () => {
  const evidence = answers<Evidence>();
  const before = performance.now();
  const here = aWhy({ evidence: evidence.ask, advises: () => false });
  const done = here.ask();
  expect(here.sinceMs).toBeGreaterThanOrEqual(before);
  expect(here.sinceMs).toBeLessThanOrEqual(performance.now());
  evidence.asked[0]?.resolve(EVIDENCE);
  await done;
});
