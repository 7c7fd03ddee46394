import { expect, test, vi } from "vitest";
import type { Track } from "../domain/types";

vi.stubGlobal("window", { location: { origin: "http://screen" } });
const { RequestFailed } = await import("../sources/api");
const { TracksAround } = await import("./tracks-around.svelte");

const TRACKS: Track[] = [{ node: "ff1", points: [] }];

/** A server that answers as a test says; what it was asked for. */
function asking(...answers: (() => Promise<Track[]>)[]) {
  const asked: [from: number, to: number][] = [];
  const known = new TracksAround((from, to) => {
    asked.push([from, to]);
    return answers[Math.min(asked.length, answers.length) - 1]?.() ?? Promise.reject(new Error("unasked"));
  }, 0);
  return { asked, known };
}
const refusal = (status: number) => () => Promise.reject(new RequestFailed(status, "The server said why."));

test("nothing is asked for before somebody wants it", async () => {
  const { asked, known } = asking(async () => TRACKS);
  await known.shows(5000);
  expect([asked, known.tracks]).toEqual([[], []]);
});

test("what is around the moment is asked for once, and anew where one has gone far from it", async () => {
  const { asked, known } = asking(async () => TRACKS);
  known.toggle();
  for (const t of [5000, 5300, 4700, 7000]) await known.shows(t);
  expect(asked).toEqual([
    [4100, 5900],
    [6100, 7900],
  ]);
  expect([known.tracks, known.busy]).toEqual([TRACKS, false]);
});

test("a sum that takes the server long is asked for until it is done; anything else is said, once", async () => {
  const slow = asking(refusal(504), refusal(504), async () => TRACKS);
  slow.known.toggle();
  await slow.known.shows(5000);
  expect([slow.asked.length, slow.known.tracks, slow.known.trouble]).toEqual([3, TRACKS, null]);

  const broken = asking(refusal(503));
  broken.known.toggle();
  await broken.known.shows(5000);
  await broken.known.shows(5000);
  expect([broken.asked.length, broken.known.trouble, broken.known.busy]).toEqual([
    1,
    "The server said why.",
    false,
  ]);
});

test("what comes after it is not wanted any more is not shown", async () => {
  let answer: (tracks: Track[]) => void = () => undefined;
  const { known } = asking(() => new Promise((resolve) => (answer = resolve)));
  known.toggle();
  const asked = known.shows(5000);
  known.leave();
  answer(TRACKS);
  await asked;
  expect([known.on, known.busy, known.tracks]).toEqual([false, false, []]);
});

test("what is shown of the time before a moment is asked for with it, and anew where more of it is wanted", async () => {
  const { asked, known } = asking(async () => TRACKS);
  known.toggle();
  for (const [t, lead_s] of [
    [5000, 300],
    [4200, 300],
    [4200, 1800],
  ] as const)
    await known.shows(t, lead_s);
  expect(asked).toEqual([
    [3800, 5900],
    [1500, 5100],
  ]);
});
