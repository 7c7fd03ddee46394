import { expect, test } from "vitest";
import { type DeepLink, formatDeepLink, parseDeepLink, takeToken } from "./deep-link";

test.each<DeepLink>([
  { incident: "i1", t: 1763712345.5, node: "ff:1", level: -1 },
  { incident: "i1", t: null, node: null, level: "all" },
  { incident: null, t: null, node: null, level: "all" },
])("a link that is written is read back the same (%o)", (link) => {
  expect(parseDeepLink(formatDeepLink(link))).toEqual(link);
});

test("a live view of everything needs no address", () => {
  expect(formatDeepLink({ incident: null, t: null, node: null, level: "all" })).toBe("");
});

test.each(["#t=soon", "#t=", "#t=Infinity", "#level=ground", "#level=1.5", "#", ""])(
  "what is not understood in %s is live on all storeys",
  (hash) => {
    expect(parseDeepLink(hash)).toEqual({ incident: null, t: null, node: null, level: "all" });
  },
);

test("a token is taken out of the address and the rest stays", () => {
  expect(takeToken("#incident=i1&token=a%2Bb&node=ff1")).toEqual({
    token: "a+b",
    rest: "#incident=i1&node=ff1",
  });
  expect(takeToken("#token=x")).toEqual({ token: "x", rest: "" });
  expect(takeToken("#incident=i1")).toEqual({ token: null, rest: "#incident=i1" });
});
