import { expect, test } from "vitest";
import { aNode, pictureWith } from "../samples";
import type { Covariance, FrameNode } from "../types";
import { around, boundsAround, type PlacedNode } from "./around";
import { K95 } from "./ellipse";

function at(e: number, n: number, sigma_m: number, role: FrameNode["role"] = "responder"): PlacedNode {
  const covariance_m2: Covariance = [sigma_m ** 2, 0, 0, (2 * sigma_m) ** 2, 0, 1];
  return { node: `at ${e} ${n}`, role, position_m: [e, n, 0], covariance_m2 };
}

test("the box holds each responder's whole ellipse", () => {
  const box = boundsAround([at(0, 0, 1), at(40, 20, 3)]);
  expect(box?.west_m).toBeCloseTo(-K95);
  expect(box?.south_m).toBeCloseTo(-2 * K95);
  expect(box?.east_m).toBeCloseTo(40 + 3 * K95);
  expect(box?.north_m).toBeCloseTo(20 + 6 * K95);
});

test("one who may be anywhere at most doubles what the others need", () => {
  expect(boundsAround([at(0, 0, 0), at(40, 20, 0), at(20, 10, 500)])).toEqual({
    west_m: 0,
    east_m: 40,
    south_m: -10,
    north_m: 30,
  });
});

test("of radios the places count, and of nobody there is no box", () => {
  const place = { west_m: 5, east_m: 5, south_m: 6, north_m: 6 };
  expect(boundsAround([at(5, 6, 100, "breadcrumb")])).toEqual(place);
  expect(boundsAround([])).toBeNull();
});

test("a UAV counts where it is chosen or alone, else beside; who is out or placed nowhere never", () => {
  const on = (selected: string | null, ...nodes: FrameNode[]) => {
    const { seen, beside } = around(pictureWith(...nodes), selected);
    return [seen.map(({ node }) => node), beside.map(({ node }) => node)];
  };
  const uav = aNode({ node: "uav", role: "uav" });
  const out = aNode({ node: "out", status: "retired" });
  const nowhere = aNode({ node: "nowhere", position_m: null });
  const inside = aNode({ node: "inside" });
  expect(on(null, uav, out, nowhere, inside)).toEqual([["inside"], ["uav"]]);
  expect(on("uav", uav, inside)).toEqual([["uav", "inside"], []]);
  expect(on(null, uav, out)).toEqual([["uav"], []]);
  expect(on(null)).toEqual([[], []]);
});
