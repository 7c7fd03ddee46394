import { expect, test } from "vitest";
import type { Shown } from "../domain/alarms/elsewhere";
import { aFrame, anAlarm, anIncident } from "../domain/samples";
import type { Incident } from "../domain/types";
import { Elsewhere } from "./elsewhere.svelte";

const HERE = anIncident({ id: "here", last_seq: 9 });
const MILL = anIncident({ id: "mill", last_seq: 4 });
const DOCK = anIncident({ id: "dock", last_seq: 7 });
const SEEN_NOW = performance.now();

/** Other incidents, of which a test may take some away or let them be out of reach. */
function world(active: Incident[]) {
  const asked: string[] = [];
  const unreachable = new Set<string>();
  const here = { incident: HERE as Incident | null };
  const frame = async (id: string): Promise<Shown> => {
    asked.push(id);
    if (unreachable.has(id)) throw new Error(`${id} is out of reach`);
    const seq = active.find((one) => one.id === id)?.last_seq ?? 0;
    return aFrame([], { seq, alarms: [anAlarm()] });
  };
  const door = { signInNeeded: false, failQuietly: () => undefined };
  return {
    asked,
    unreachable,
    here,
    elsewhere: new Elsewhere({ active: async () => active, frame }, here, door),
  };
}

test("an incident is looked into once, and again when its log has grown", async () => {
  const active = [HERE, MILL];
  const { elsewhere, asked } = world(active);
  await elsewhere.look();
  await elsewhere.look();
  expect(asked).toEqual(["mill"]);
  active[1] = { ...MILL, last_seq: 5 };
  await elsewhere.look();
  expect(asked).toEqual(["mill", "mill"]);
});

test("one that is out of reach hides no other, and is asked for again", async () => {
  const { elsewhere, asked, unreachable } = world([HERE, MILL, DOCK]);
  unreachable.add("mill");
  await expect(elsewhere.look()).rejects.toThrow("mill is out of reach");
  expect([...elsewhere.glimpses.keys()]).toEqual(["dock"]);
  unreachable.clear();
  await elsewhere.look();
  expect(asked).toEqual(["mill", "dock", "mill"]);
  expect([...elsewhere.glimpses.keys()].sort()).toEqual(["dock", "mill"]);
});

test("what was seen of an incident is forgotten while it is shown, and looked up when it is left", async () => {
  const { elsewhere, asked, here } = world([HERE, MILL]);
  await elsewhere.look();
  here.incident = MILL;
  await elsewhere.look();
  expect([...elsewhere.glimpses.keys()]).toEqual(["here"]);
  here.incident = HERE;
  await elsewhere.look();
  expect(asked).toEqual(["mill", "here", "mill"]);
});

test("where the commander has just been, what was seen before is forgotten", async () => {
  const { elsewhere, asked } = world([HERE, MILL]);
  await elsewhere.look();
  elsewhere.forget("mill");
  expect(elsewhere.glimpses.size).toBe(0);
  await elsewhere.look();
  expect(asked).toEqual(["mill", "mill"]);
});

test("it is said when nothing has been seen for a while, where there is something to be seen", async () => {
  const { elsewhere, unreachable } = world([HERE, MILL]);
  expect(elsewhere.silentS(SEEN_NOW + 60_000)).toBeNull();
  unreachable.add("mill");
  await expect(elsewhere.look()).rejects.toThrow();
  expect(elsewhere.silentS(SEEN_NOW + 60_000)).toBeCloseTo(60, 0);
  unreachable.clear();
  await elsewhere.look();
  expect(elsewhere.silentS(performance.now() + 4000)).toBeNull();
});

test("a look that was under way while the commander was there does not bring back what was seen before", async () => {
  const { elsewhere } = world([HERE, MILL]);
  const look = elsewhere.look();
  elsewhere.forget("mill");
  await look;
  expect(elsewhere.glimpses.size).toBe(0);
  await elsewhere.look();
  expect([...elsewhere.glimpses.keys()]).toEqual(["mill"]);
});
