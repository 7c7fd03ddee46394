import { expect, test } from "vitest";
import { actOf, KEY_HELP, type KeyPress } from "./keys";

const press = (key: string, held: Partial<KeyPress> = {}): KeyPress => ({
  key,
  shiftKey: false,
  ctrlKey: false,
  altKey: false,
  metaKey: false,
  ...held,
});

test("space plays, arrows step a second, with shift they move the map", () => {
  expect(actOf(press(" "), true)).toEqual({ do: "playPause" });
  expect(actOf(press("ArrowLeft"), true)).toEqual({ do: "step", seconds: -1 });
  expect(actOf(press("ArrowLeft", { shiftKey: true }), true)).toMatchObject({ do: "pan", dx: 80 });
});

test.each(["ctrlKey", "altKey", "metaKey"] as const)("with %s held a key is the browser's", (held) => {
  expect(actOf(press("f", { [held]: true }), true)).toBeNull();
});

test("letters work with caps lock, and signs that need shift work with it", () => {
  expect(actOf(press("F", { shiftKey: true }), true)).toEqual({ do: "fit" });
  expect(actOf(press("?", { shiftKey: true }), true)).toEqual({ do: "help" });
});

test("with single keys off only named keys act", () => {
  expect(actOf(press("b"), false)).toBeNull();
  expect(actOf(press("+"), false)).toBeNull();
  expect(actOf(press("ArrowRight"), false)).toEqual({ do: "step", seconds: 1 });
});

test.each(["Enter", "Tab", "x"])("%s does nothing", (key) => {
  expect(actOf(press(key), true)).toBeNull();
});

test("every letter on the help sheet does something", () => {
  const letters = KEY_HELP.flatMap(([keys]) => keys.split(" ")).filter((key) => /^[A-Z]$/.test(key));
  expect(letters.length).toBeGreaterThan(5);
  for (const letter of letters) expect(actOf(press(letter), true)).not.toBeNull();
});
