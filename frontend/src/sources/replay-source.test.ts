import { afterEach, beforeEach, expect, test, vi } from "vitest";
import { aFrame, aNode, NOON } from "../domain/samples";
import { ReplaySource } from "./replay-source";
import type { Listener } from "./source";

/** The server's end of the newest socket. */
class Line {
  static readonly OPEN = 1;
  static last: Line;
  readyState = 0;
  readonly said: object[] = [];
  onopen: (() => void) | null = null;
  onmessage: ((event: { data: string }) => void) | null = null;
  onclose: (() => void) | null = null;

  constructor(readonly address: string) {
    Line.last = this;
  }

  opens(): void {
    this.readyState = Line.OPEN;
    this.onopen?.();
  }

  says(type: "frame" | "delta" | "heartbeat", t: number): void {
    const picture = { ...aFrame([aNode()], { clock_t: t, t }), type };
    const message =
      type === "heartbeat" ? { type, t, seq: 1, paused: false, speed: 1, ended: false } : picture;
    this.onmessage?.({ data: JSON.stringify(message) });
  }

  send(message: string): void {
    this.said.push(JSON.parse(message));
  }

  close(): void {}
}

let heard: [string, number | null][];
let source: ReplaySource;

beforeEach(() => {
  vi.useFakeTimers();
  vi.stubGlobal("window", {
    addEventListener: () => undefined,
    removeEventListener: () => undefined,
    location: { protocol: "http:", host: "here" },
  });
  vi.stubGlobal("WebSocket", Line);
  heard = [];
  const noted = (type: string) => (_: object, t: number | null) => heard.push([type, t]);
  source = new ReplaySource("i1", { begin: NOON, at: NOON + 50, to: NOON + 100, speed: 1, paused: true });
  source.subscribe({
    frame: noted("frame"),
    delta: noted("delta"),
    heartbeat: noted("heartbeat"),
    state: () => undefined,
  } satisfies Listener);
});

afterEach(() => {
  source.close();
  vi.useRealTimers();
  vi.unstubAllGlobals();
});

test("nothing is heard of the beginning, which a server shows before it has been told where to go", () => {
  Line.last.opens();
  Line.last.says("frame", NOON);
  Line.last.says("delta", NOON + 0.1);
  Line.last.says("frame", NOON + 50);
  Line.last.says("delta", NOON + 50);
  expect(heard).toEqual([
    ["frame", NOON + 50],
    ["delta", NOON + 50],
  ]);
});

test("however long the answer takes, no change to the beginning is laid over what is shown", () => {
  Line.last.opens();
  Line.last.says("frame", NOON);
  vi.advanceTimersByTime(4000);
  Line.last.says("delta", NOON + 4);
  Line.last.says("heartbeat", NOON + 4);
  expect(heard).toEqual([]);
  Line.last.says("frame", NOON + 50);
  expect(heard).toEqual([["frame", NOON + 50]]);
});

test("a server that goes on without a whole frame is asked again, and not with each word of it", () => {
  Line.last.opens();
  Line.last.says("frame", NOON);
  for (let second = 0; second < 5; second += 1) {
    Line.last.says("heartbeat", NOON + 50);
    Line.last.says("delta", NOON + 50);
    vi.advanceTimersByTime(1000);
  }
  expect(Line.last.said.slice(2)).toEqual([{ seek: NOON + 50 }, { seek: NOON + 50 }]);
  Line.last.says("frame", NOON + 50);
  expect(heard).toEqual([["frame", NOON + 50]]);
});

test("what was on its way when a moment was sought tells no time, nor does a heartbeat of that moment", () => {
  Line.last.opens();
  Line.last.says("frame", NOON + 50);
  source.seek(NOON + 20);
  Line.last.says("delta", NOON + 50.1);
  Line.last.says("heartbeat", NOON + 20);
  Line.last.says("frame", NOON + 20);
  Line.last.says("heartbeat", NOON + 20);
  expect(heard.slice(1)).toEqual([
    ["delta", null],
    ["heartbeat", null],
    ["frame", NOON + 20],
    ["heartbeat", NOON + 20],
  ]);
});

test("a replay whose server comes back is told again how fast to go, that it stands, and where", () => {
  Line.last.opens();
  Line.last.says("frame", NOON + 50);
  source.seek(NOON + 70);
  Line.last.says("frame", NOON + 70);
  Line.last.onclose?.();
  vi.advanceTimersByTime(400);
  Line.last.opens();
  expect(Line.last.said).toEqual([{ speed: 1 }, { pause: true }, { seek: NOON + 70 }]);
});
