import { expect, test } from "vitest";
import { Awake } from "./awake";

class Light {
  released = false;
  async release() {
    this.released = true;
  }
}

class Device extends EventTarget {
  readonly given: Light[] = [];
  refuses = false;
  visibilityState: DocumentVisibilityState = "visible";

  async request(): Promise<WakeLockSentinel> {
    if (this.refuses) throw new Error("the battery is low");
    this.given.push(new Light());
    return this.given.at(-1) as unknown as WakeLockSentinel;
  }

  get lit(): boolean {
    return this.given.some(({ released }) => !released);
  }

  async isTold(of: "visibilitychange" | "pointerdown"): Promise<void> {
    this.dispatchEvent(new Event(of));
    await Promise.resolve();
  }
}

test("the screen is kept lit while that is wanted, by one light", async () => {
  const device = new Device();
  const awake = new Awake(device as unknown as WakeLock, device);
  await awake.keep(true);
  await awake.keep(true);
  await device.isTold("pointerdown");
  expect([device.lit, device.given.length]).toEqual([true, 1]);
  await awake.keep(false);
  await device.isTold("pointerdown");
  expect([device.lit, device.given.length]).toEqual([false, 1]);
});

test("what the system took away is asked for again when the page is looked at again, not before", async () => {
  const device = new Device();
  await new Awake(device as unknown as WakeLock, device).keep(true);
  await device.given[0]?.release();
  device.visibilityState = "hidden";
  await device.isTold("visibilitychange");
  expect(device.lit).toBe(false);
  device.visibilityState = "visible";
  await device.isTold("visibilitychange");
  expect(device.lit).toBe(true);
});

test("what is refused is asked for again with the next touch", async () => {
  const device = new Device();
  device.refuses = true;
  await new Awake(device as unknown as WakeLock, device).keep(true);
  expect(device.lit).toBe(false);
  device.refuses = false;
  await device.isTold("pointerdown");
  expect(device.lit).toBe(true);
});

test("a light that comes when none is wanted any more is let go", async () => {
  const device = new Device();
  const awake = new Awake(device as unknown as WakeLock, device);
  await Promise.all([awake.keep(true), awake.keep(false)]);
  expect([device.given.length, device.lit]).toEqual([1, false]);
});

test("where the browser has none it says so, and nothing breaks", async () => {
  const awake = new Awake(undefined, new Device());
  await awake.keep(true);
  expect(awake.possible).toBe(false);
});
