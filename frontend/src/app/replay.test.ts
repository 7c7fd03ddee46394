import { afterEach, beforeEach, expect, test, vi } from "vitest";
import { aFrame, aNode, anIncident, NOON } from "../domain/samples";
import { incidentTime } from "../domain/time/clock";
import type { HeartbeatMessage } from "../domain/types";
import type { Listener } from "../sources/source";
import { Replay } from "./replay.svelte";

/** What the newest source was told, and the way to tell something by it. */
let way: { listener: Listener; told: [string, unknown][] };

vi.mock("../sources/replay-source", () => ({
  ReplaySource: class {
    subscribe(listener: Listener) {
      way = { listener, told: [] };
      return () => undefined;
    }
    seek(t: number) {
      way.told.push(["seek", t]);
    }
    setPaused(paused: boolean) {
      way.told.push(["paused", paused]);
    }
    setSpeed(speed: number) {
      way.told.push(["speed", speed]);
    }
    close() {}
  },
}));

let replay: Replay;
let showsPresent: boolean;

beforeEach(() => {
  vi.useFakeTimers();
  showsPresent = true;
  replay = new Replay({
    incident: anIncident({ first_t: NOON, last_t: NOON + 100 }),
    extent: { from: NOON, to: NOON + 100 },
    get now(): number {
      return shownT();
    },
    get showsPresent(): boolean {
      return showsPresent;
    },
  });
});

afterEach(() => {
  vi.useRealTimers();
});

function shownT(): number {
  return incidentTime(replay.feed.clock, performance.now());
}

/** A picture of a moment; one that was on its way when another was sought tells no time. */
function shows(t: number, asked = true): void {
  way.listener.frame(aFrame([aNode()], { clock_t: t }), asked ? t : null);
}

function beats(t: number, ended = false): void {
  const beat: HeartbeatMessage = { type: "heartbeat", t, seq: 1, paused: false, speed: 1, ended };
  way.listener.heartbeat(beat, t);
}

test("until what was sought is shown, the clock stands at the moment of what is shown", () => {
  replay.begin(NOON + 50, false);
  shows(NOON + 50);
  vi.advanceTimersByTime(2000);
  expect(shownT()).toBeCloseTo(NOON + 52);
  replay.seek(NOON + 10);
  vi.advanceTimersByTime(1500);
  expect([shownT(), replay.soughtT]).toEqual([NOON + 52, NOON + 10]);
  shows(NOON + 52.1, false);
  expect([shownT(), replay.soughtT]).toEqual([NOON + 52.1, NOON + 10]);
  shows(NOON + 10);
  expect([shownT(), replay.soughtT]).toEqual([NOON + 10, null]);
  vi.advanceTimersByTime(1000);
  expect(shownT()).toBeCloseTo(NOON + 11);
});

test("whoever goes back from the end is shown a replay that stands, as the button says", () => {
  replay.begin(NOON + 99, false);
  shows(NOON + 99);
  beats(NOON + 100, true);
  beats(NOON + 100, true);
  expect([replay.paused, way.told]).toEqual([true, [["paused", true]]]);
});

test("a moment sought while the server is away stands over no other picture, nor does it go on", () => {
  replay.begin(NOON + 50, false);
  shows(NOON + 50);
  way.listener.state({ link: "lost", lastWordMs: 0, attempts: 1 });
  replay.seek(NOON + 10);
  expect([replay.feed.picture, shownT()]).toEqual([null, NOON + 10]);
  vi.advanceTimersByTime(3000);
  expect(shownT()).toBe(NOON + 10);
});

test("until the past has come, the present is what is shown; without one, nothing is", () => {
  replay.begin(NOON + 50, true);
  expect([replay.on, replay.shown, replay.soughtT]).toEqual([true, false, NOON + 50]);
  shows(NOON + 50);
  expect([replay.shown, replay.soughtT]).toEqual([true, null]);
  replay.end();
  expect(replay.shown).toBe(false);
  showsPresent = false;
  replay.begin(NOON + 50, true);
  expect([replay.shown, replay.feed.picture]).toEqual([true, null]);
});

test("who looks further than the replay reaches keeps the last picture, at its moment, until the next comes", () => {
  replay.begin(NOON + 50, false);
  shows(NOON + 50);
  replay.begin(NOON + 99, false);
  vi.advanceTimersByTime(1500);
  expect([replay.shown, replay.feed.picture?.clockT, shownT()]).toEqual([true, NOON + 50, NOON + 50]);
  shows(NOON + 99);
  expect([replay.feed.picture?.clockT, shownT()]).toEqual([NOON + 99, NOON + 99]);
});

test("a replay that is begun anew while the server is away shows no other moment", () => {
  replay.begin(NOON + 50, false);
  shows(NOON + 50);
  way.listener.state({ link: "lost", lastWordMs: 0, attempts: 1 });
  replay.begin(NOON + 10, false);
  expect([replay.shown, replay.feed.picture, shownT()]).toEqual([true, null, NOON + 10]);
});
