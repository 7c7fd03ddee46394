import { expect, test } from "vitest";
import { aNode, NOON, pictureWith, STOREYS } from "../samples";
import { storeyWords } from "./levels";
import { storeyProbability, withStoreysAged } from "./storey-age";

// Floors at 0, 3.2 and 6.4 m; what the server's estimator/levels.py gives for them.
test.each([
  [0, 1, 0.942024],
  [3.2, 1, 0.890403],
  [3.2, 2, 0.742612],
  [3, 82, 0.347197],
  [0, 37, 0.407207],
])(
  "a height of %d m with a variance of %d m² is on its storey as the server has it: %d",
  (up_m, variance, p) => {
    expect(storeyProbability(STOREYS, up_m, variance)).toBeCloseTo(p, 5);
  },
);

const upstairs = aNode({
  position_m: [2, 3, 3.2],
  covariance_m2: [1, 0, 0, 1, 0, 0.04],
  level: 1,
  level_p: 0.99,
});
const said = (now: number, node = upstairs) => {
  const aged = withStoreysAged(pictureWith(node), now, STOREYS)?.nodes.get("ff1")?.state;
  return storeyWords(aged ?? expect.fail(), STOREYS);
};

test("while nothing is heard a storey becomes as unsure as the height, not certain for ever", () => {
  expect(said(NOON + 1)).toBe("Level 1");
  // The height has 0.1 m a second more to be unsure by.
  expect(said(NOON + 90)).toBe("Level 1, 35 %");
});

test("what stands stays on its storey, and who is not tracked is not followed any further", () => {
  expect(said(NOON + 90, { ...upstairs, role: "breadcrumb" })).toBe("Level 1");
  expect(said(NOON + 90, { ...upstairs, status: "retired" })).toBe("Level 1");
});

test("a picture in which nothing has aged stays the very same", () => {
  const picture = pictureWith(upstairs);
  expect(withStoreysAged(picture, NOON + 0.5, STOREYS)).toBe(picture);
});
