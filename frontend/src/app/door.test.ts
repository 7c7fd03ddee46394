import { afterEach, beforeEach, expect, test, vi } from "vitest";
import { anIncident } from "../domain/samples";
import { type DeepLink, NOTHING } from "../domain/screen/deep-link";
import type { Incident } from "../domain/types";
import { Door } from "./door.svelte";

/** What was asked of the server and waits for its answer, the oldest first. */
let asked: { what: string; answers(value: unknown): void; fails(cause: Error): void }[];

vi.mock("../sources/api", () => {
  const waits = (what: string) =>
    new Promise((resolve, reject) => asked.push({ what, answers: resolve, fails: reject }));
  class RequestFailed extends Error {
    status = 0;
  }
  return { RequestFailed, incident: (id: string) => waits(id), incidents: () => waits("list") };
});

let opened: string[];
let door: Door;

beforeEach(() => {
  asked = [];
  opened = [];
  const owner = {
    incident: null as Incident | null,
    shown: { ...NOTHING, incident: "mill" } as DeepLink,
    pastT: null,
    lossIsSaid: false,
    open: (incident: Incident) => opened.push(incident.id),
    renewed: () => undefined,
  };
  door = new Door(owner);
});

afterEach(() => {
  vi.restoreAllMocks();
});

/** The server answers a question at last, though others have come since. */
async function answer(what: string, value: unknown): Promise<void> {
  const at = asked.findIndex((one) => one.what === what);
  asked.splice(at, 1)[0]?.answers(value);
  await new Promise((resolve) => setTimeout(resolve));
}

test("of two incidents chosen one after the other the second is shown, whichever the server tells of first", async () => {
  void door.choose("mill");
  void door.choose("dock");
  await answer("dock", anIncident({ id: "dock" }));
  await answer("mill", anIncident({ id: "mill" }));
  expect(opened).toEqual(["dock"]);
});

test("what the address names is not opened over what was chosen while the list was read", async () => {
  void door.begin();
  void door.choose("dock");
  await answer("dock", anIncident({ id: "dock" }));
  await answer("list", [anIncident({ id: "mill" }), anIncident({ id: "dock" })]);
  expect([opened, asked]).toEqual([["dock"], []]);
  expect(door.incidents.map(({ id }) => id)).toEqual(["mill", "dock"]);
});

test("an incident opened since the list was read is in the list as soon as it is shown", async () => {
  const listed = door.refresh();
  await answer("list", [anIncident({ id: "mill" })]);
  await listed;
  void door.choose("new");
  await answer("new", anIncident({ id: "new" }));
  expect([opened, door.incidents.map(({ id }) => id)]).toEqual([["new"], ["new", "mill"]]);
});

test("a request that fails after a later one was answered is no trouble any more", async () => {
  const early = door.refresh();
  const late = door.refresh();
  const [first, second] = asked;
  second?.answers([anIncident({ id: "dock" })]);
  await late;
  first?.fails(new Error("The server cannot be reached"));
  await early;
  expect([door.trouble, door.incidents.length]).toEqual([null, 1]);
});

test("an older list does not replace a newer one", async () => {
  const early = door.refresh();
  const late = door.refresh();
  const [first, second] = asked;
  second?.answers([anIncident({ id: "dock" }), anIncident({ id: "mill" })]);
  await late;
  first?.answers([anIncident({ id: "dock" })]);
  await early;
  expect(door.incidents.length).toBe(2);
});
