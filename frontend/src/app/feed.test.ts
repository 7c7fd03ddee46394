import { afterEach, expect, test, vi } from "vitest";
import { aFrame, aNode, NOON } from "../domain/samples";
import { incidentTime } from "../domain/time/clock";
import { type LinkState, type Listener, NOT_CONNECTED, type Source } from "../sources/source";
import { Feed } from "./feed.svelte";

/** A way to the server on which a test says what happens. */
class Way implements Source {
  private listener: Listener | null = null;
  subscribe(listener: Listener): () => void {
    this.listener = listener;
    listener.state(NOT_CONNECTED);
    return () => undefined;
  }
  close(): void {}
  becomes(link: LinkState["link"]): void {
    this.listener?.state({ link, lastWordMs: null, attempts: 0 });
  }
  shows(t = NOON): void {
    this.listener?.frame(aFrame([aNode()], { clock_t: t, t }), t);
  }
}

afterEach(() => {
  vi.useRealTimers();
});

function followed(): { feed: Feed; way: Way } {
  const way = new Way();
  const nothing = () => undefined;
  const feed = new Feed({
    onward: true,
    rate: () => 1,
    changed: nothing,
    heartbeat: nothing,
    lost: nothing,
    back: nothing,
  });
  feed.follow(way);
  return { feed, way };
}

test("a first attempt that takes long is no lost connection; one that has failed is", () => {
  const { feed, way } = followed();
  expect([feed.isLost, feed.picture]).toEqual([false, null]);
  way.becomes("lost");
  expect(feed.isLost).toBe(true);
});

test("what was shown stays while the connection is lost, and is no loss any more when it is back", () => {
  const { feed, way } = followed();
  way.becomes("open");
  way.shows();
  way.becomes("lost");
  expect([feed.isLost, feed.picture?.nodes.size]).toEqual([true, 1]);
  way.becomes("open");
  expect(feed.isLost).toBe(false);
});

test("a live picture that was long under way makes nobody's fix younger", () => {
  vi.useFakeTimers();
  const { feed, way } = followed();
  way.shows(NOON);
  vi.advanceTimersByTime(9000);
  way.shows(NOON + 5);
  expect(incidentTime(feed.clock, performance.now())).toBe(NOON + 9);
});
