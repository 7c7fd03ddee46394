import { expect, test } from "vitest";
import { type DeepLink, NOTHING } from "../domain/screen/deep-link";
import { Address } from "./address";

/** A browser's history, as far as an address goes. */
class Past {
  entries: { state: unknown; hash: string }[] = [{ state: null, hash: "" }];
  at = 0;
  readonly history = {
    pushState: (state: unknown, _: string, url?: string | URL | null) => {
      this.entries = [...this.entries.slice(0, this.at + 1), { state, hash: String(url) }];
      this.at += 1;
    },
    replaceState: (state: unknown, _: string, url?: string | URL | null) => {
      this.entries[this.at] = { state, hash: String(url) };
    },
  };
  get location() {
    return { hash: this.entries[this.at]?.hash ?? "", pathname: "/" };
  }
  go(by: number): unknown {
    this.at += by;
    return this.entries[this.at]?.state;
  }
}

function opened(): { past: Past; address: Address; live: DeepLink } {
  const past = new Past();
  const address = new Address(past);
  const live = { ...NOTHING, incident: "i1" };
  address.write(NOTHING);
  address.write(live);
  return { past, address, live };
}

test("opening the first incident is no step: who goes back from there leaves the screen", () => {
  expect(opened().past.at).toBe(0);
});

test("who goes back closes the card, and stays on the storey", () => {
  const { past, address, live } = opened();
  address.write({ ...live, node: "ff1" });
  address.write({ ...live, node: "ff2" });
  address.write({ ...live, node: "ff2", level: 1 });
  expect(past.at).toBe(1);
  expect(address.read(past.go(-1))).toEqual({ ...live, node: null, level: 1 });
  address.write({ ...live, level: 1 });
  expect([past.at, past.entries.length]).toEqual([0, 2]);
  expect(address.read(past.go(1))).toEqual({ ...live, node: "ff2", level: 1 });
});

test("who goes back from another incident comes to the one before, and on again", () => {
  const { past, address, live } = opened();
  address.write({ ...live, level: 2 });
  address.write({ ...NOTHING, incident: "i2" });
  expect(address.read(past.go(-1))).toEqual({ ...live, level: 2 });
  address.write({ ...live, level: 2 });
  expect(address.read(past.go(1))).toEqual({ ...NOTHING, incident: "i2" });
});

test("an address that a person writes is followed whole", () => {
  const { past, address } = opened();
  past.entries[past.at] = { state: null, hash: "#incident=i1&t=100.0&level=1" };
  expect(address.read(null)).toEqual({ incident: "i1", t: 100, node: null, level: 1 });
});
