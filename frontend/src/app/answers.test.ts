import { expect, test } from "vitest";
import { anAlarm } from "../domain/samples";
import { Answers } from "./answers.svelte";

/** Answers of which the first so many are lost on their way, and the names under which they were sent. */
function losing(first: number): { answers: Answers; sent: string[] } {
  const sent: string[] = [];
  let names = 0;
  const answers = new Answers(
    async (batch) => {
      sent.push(batch);
      if (sent.length <= first) throw new Error("The server did not answer.");
    },
    () => `name ${++names}`,
  );
  return { answers, sent };
}

test("an answer that may not have arrived is sent again under the same name: the log takes it once", async () => {
  const { answers, sent } = losing(1);
  expect(await answers.say(anAlarm(), "acknowledged")).toBe(false);
  expect(answers.refused).toBe("Not sent: The server did not answer. Press again.");
  expect(await answers.say(anAlarm(), "acknowledged")).toBe(true);
  expect([answers.refused, answers.busy]).toEqual([null, false]);
  expect(sent[1]).toBe(sent[0]);
});

test("each other answer, and one that is given again later, has a name of its own", async () => {
  const { answers, sent } = losing(0);
  await answers.say(anAlarm(), "acknowledged");
  await answers.say(anAlarm(), "cleared");
  await answers.say(anAlarm(), "acknowledged");
  expect(new Set(sent).size).toBe(3);
});
