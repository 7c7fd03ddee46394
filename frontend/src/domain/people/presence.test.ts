import { expect, test } from "vitest";
import { badgeOf, type Looking, liveWords, newestButton, presenceOf } from "./presence";

const OPEN: Looking = { replay: false, closed: false, recorded: false, heard: true };

test("an open incident that is heard is live", () => {
  expect(presenceOf(OPEN)).toBe("live");
});

test.each<[string, Partial<Looking>, string, string]>([
  ["while nothing is heard", { heard: false }, "NOT LIVE", "Not live"],
  ["once the incident is closed", { closed: true }, "CLOSED", "Closed"],
  ["of a closed incident without a connection", { closed: true, heard: false }, "CLOSED", "Closed"],
  ["of an import, whose time does not go on by itself", { recorded: true }, "RECORDED", "Recorded"],
  ["in a replay of an import", { recorded: true, replay: true }, "REPLAY", "Back to the end"],
  ["in a replay", { replay: true }, "REPLAY", "Back to live"],
  ["in a replay of a closed incident", { replay: true, closed: true }, "REPLAY", "Back to the end"],
])("nothing says that it is live %s", (_, looking, badge, button) => {
  const presence = presenceOf({ ...OPEN, ...looking });
  expect(badgeOf(presence)).toBe(badge);
  expect(newestButton(presence, { ...OPEN, ...looking })).toBe(button);
});

test("nobody is live in an incident that is over, in one whose time stands, nor in the past", () => {
  expect([liveWords(3, "closed"), liveWords(1, "recorded")]).toEqual(["3 were live", "1 was live"]);
  expect([liveWords(3, "live"), liveWords(3, "replay")]).toEqual(["3 live", "3 were live"]);
});
