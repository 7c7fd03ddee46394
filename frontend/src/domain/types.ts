/** The contract's schemas under the field's names. Lengths m, angles rad, times Unix seconds. */
import type { components } from "../sources/schema";

type Schemas = components["schemas"];

export type Role = Schemas["FrameNode"]["role"];
export type Status = Schemas["FrameNode"]["status"];
export type Level = Schemas["Level"];
export type Incident = Schemas["Incident"];
export type Stretch = Schemas["Stretch"];
export type Frame = Schemas["Frame"];
export type FrameNode = Schemas["FrameNode"];
export type FrameAlarm = Schemas["FrameAlarm"];
export type FrameMessage = Schemas["FrameMessage"];
export type DeltaMessage = Schemas["DeltaMessage"];
export type HeartbeatMessage = Schemas["HeartbeatMessage"];
export type LiveMessage = Schemas["LiveMessage"];
export type Track = Schemas["Track"];
export type Evidence = Schemas["Evidence"];
export type Measurement = Schemas["Measurement"];
export type Advice = Schemas["Advice"];
export type Suggestion = Schemas["Suggestion"];

/** East, north, up (m). */
export type Position = [number, number, number];
/** Upper triangle ee, en, eu, nn, nu, uu (m²). */
export type Covariance = [number, number, number, number, number, number];
