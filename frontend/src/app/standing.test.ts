import { expect, test } from "vitest";
import { inOrder } from "../domain/alarms/alarms";
import { anAlarm, NOON } from "../domain/samples";
import { Standing } from "./standing.svelte";

const raised = anAlarm();
const words = (standing: Standing) =>
  inOrder(standing.list).map(({ alarm, acknowledged }) => [alarm.t, acknowledged]);

/** A mayday that has been acknowledged here, as entry 7 of the log. */
function acknowledged(): Standing {
  const standing = new Standing();
  standing.heard({ seq: 5, alarms: [raised] });
  standing.answered(raised, "acknowledged", 7);
  return standing;
}

test("a picture that does not have an answer yet does not take it back", () => {
  const standing = acknowledged();
  expect(words(standing)).toEqual([[NOON, true]]);
  standing.heard({ seq: 6, alarms: [raised] });
  expect(words(standing)).toEqual([[NOON, true]]);
  standing.answered(raised, "cleared", 8);
  standing.heard({ seq: 6, alarms: [raised] });
  expect(words(standing)).toEqual([]);
});

test("from the picture on that has an answer, what stands is what the server lists", () => {
  const standing = acknowledged();
  standing.heard({ seq: 7, alarms: [raised] });
  expect(words(standing)).toEqual([[NOON, false]]);
});

test("an answer to one call is none to the next one", () => {
  const standing = acknowledged();
  standing.heard({ seq: 6, alarms: [anAlarm({ t: NOON + 60 })] });
  expect(words(standing)).toEqual([[NOON + 60, false]]);
});

test("what was answered in one incident is forgotten in another", () => {
  const standing = acknowledged();
  standing.clear();
  expect(words(standing)).toEqual([]);
  standing.heard({ seq: 1, alarms: [raised] });
  expect(words(standing)).toEqual([[NOON, false]]);
});
