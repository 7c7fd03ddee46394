/** Clocks that are behind: what is to be set, and what is shown wrongly until then. */
import type { FrameMessage } from "../types";
import { nameInText, shortAge } from "../words";

/** One clock, in words that stay the same while only its age goes on. */
export function behindInWords({ gateway, behind_s, clock_of }: FrameMessage["clocks"][number]): string {
  const [name, by] = [nameInText(gateway), shortAge(behind_s)];
  return clock_of === "gateway"
    ? `Clock of gateway ${name} is ${by} behind: set it.`
    : `Clocks of the units heard by gateway ${name} are ${by} behind: set them.`;
}

/** What that does to the picture. */
export function untilSet(gateways: number): string {
  return `Until then whoever ${gateways === 1 ? "it hears" : "they hear"} is shown as stale or lost, or not at all.`;
}
