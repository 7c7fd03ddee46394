import { expect, test } from "vitest";
import { ANSWERED_WITHIN_MS, answers } from "./seeking";

const sought = { t: 500, localMs: 1000 };

test("what was on its way when a moment was sought is no answer", () => {
  expect(answers(sought, 501, 1040, 1)).toBe(false);
  expect(answers(sought, 300, 1040, 1)).toBe(false);
});

test("the moment itself is, and what is played from it", () => {
  expect(answers(sought, 500, 1040, 1)).toBe(true);
  expect(answers(sought, 500.03, 1040, 1)).toBe(true);
  expect(answers(sought, 500.3, 1040, 1)).toBe(false);
  expect(answers(sought, 500.3, 1040, 8)).toBe(true);
});

test("nobody waits for an answer for long: the server may not go there", () => {
  expect(answers(sought, 480, 1000 + ANSWERED_WITHIN_MS + 1, 1)).toBe(true);
});
