import { expect, test } from "vitest";
import { anAlarm } from "../domain/samples";
import { Answers } from "./answers.svelte";

/** Answers of which the first so many are lost on their way, and the names under which they were sent. */
function losing(first: number): { answers: Answers; sent: string[] } {
  const sent: string[] = [];
  let names = 0;
  const answers = new Answers(
    async (_, batch) => {
      sent.push(batch);
      if (sent.length <= first) throw new Error("The server did not answer.");
      return sent.length;
    },
    () => `name ${++names}`,
  );
  return { answers, sent };
}

test("an answer that may not have arrived is sent again under the same name: the log takes it once", async () => {
  const { answers, sent } = losing(1);
  expect(await answers.say("mill", anAlarm(), "acknowledged")).toBe(null);
  expect(answers.refused).toBe("Not sent: The server did not answer. Press again.");
  expect(await answers.say("mill", anAlarm(), "acknowledged")).toBe(2);
  expect([answers.refused, answers.busy]).toEqual([null, false]);
  expect(sent[1]).toBe(sent[0]);
});

test("each other answer, and one that is given again later, has a name of its own", async () => {
  const { answers, sent } = losing(0);
  await answers.say("mill", anAlarm(), "acknowledged");
  await answers.say("mill", anAlarm(), "cleared");
  await answers.say("mill", anAlarm(), "acknowledged");
  expect(new Set(sent).size).toBe(3);
});

test("what is lost on its way to one incident lends no name to the same word in another", async () => {
  const { answers, sent } = losing(1);
  await answers.say("mill", anAlarm(), "acknowledged");
  await answers.say("dock", anAlarm(), "acknowledged");
  expect(new Set(sent).size).toBe(2);
});
