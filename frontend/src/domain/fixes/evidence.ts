/** What holds a fix where it is, in the commander's words. */
import type { Advice, Evidence, Measurement, Position, Suggestion } from "../types";
import { metres, sideways } from "../words";

/** As many measurements are listed: those with the largest shares, and the newest of the rejected. */
const MOST_HELD = 5;
const MOST_REJECTED = 3;
/** What holds less than this is not worth a line; the foremost gets one always. */
const LEAST_SHARE = 0.01;

const ABOUT_ONE: Record<Measurement["kind"], string> = {
  range: "Range",
  rssi: "Radio signal",
  reach: "Edge of reach",
  bearing: "Bearing",
  fix: "Position fix",
  height: "Height",
  stillness: "Standing still",
  straightness: "Straight walk",
  drop: "Breadcrumb drop",
  displacement: "Own steps",
  prior: "Known beforehand",
};

export interface EvidenceLine {
  /** What was measured, and with whom. */
  readonly what: string;
  /** Its epoch (Unix s). */
  readonly t: number;
  /** Of the fix's uncertainty, 0 to 1. */
  readonly share: number;
  /** How it agrees with the fix: "1.2 m too long". */
  readonly off: string;
}

export interface EvidenceList {
  readonly held: readonly EvidenceLine[];
  readonly rejected: readonly EvidenceLine[];
  /** Share of everything that is not in `held`. */
  readonly rest: number;
  /** How many more were rejected. */
  readonly moreRejected: number;
}

/** `name` gives the spoken name of a node. */
export function evidenceList(evidence: Evidence, name: (node: string) => string): EvidenceList {
  const line = (one: Measurement): EvidenceLine => ({
    what: whatWords(one, evidence.node, name),
    t: one.t,
    share: one.share,
    off: offWords(one),
  });
  const held = evidence.held
    .slice(0, MOST_HELD)
    .filter(({ share }, place) => place === 0 || share >= LEAST_SHARE);
  const rejected = evidence.rejected.slice(0, MOST_REJECTED);
  return {
    held: held.map(line),
    rejected: rejected.map(line),
    rest: Math.max(0, 1 - held.reduce((sum, { share }) => sum + share, 0)),
    moreRejected: evidence.rejected.length - rejected.length,
  };
}

/** "Range to BC12", "Radio signal BC3 – base", "Own steps". */
function whatWords(one: Measurement, node: string, name: (node: string) => string): string {
  const word = ABOUT_ONE[one.kind];
  if (one.b == null || one.b === one.a) return one.a === node ? word : `${word}, ${name(one.a)}`;
  if (one.a !== node && one.b !== node) return `${word} ${name(one.a)} – ${name(one.b)}`;
  const other = name(one.a === node ? one.b : one.a);
  switch (one.kind) {
    case "range":
      return `${word} to ${other}`;
    case "bearing":
      return one.a === node ? `${word} to ${other}` : `${word} from ${other}`;
    case "rssi":
      return `${word} with ${other}`;
    case "reach":
      return `${word} of ${other}`;
    case "drop":
      return `Dropped ${other} here`;
    default:
      return `${word}, ${other}`;
  }
}

/** What was read less what the fix says, with its unit. */
function offWords({ kind, residual }: Measurement): string {
  switch (kind) {
    case "range":
      return signed(metres(Math.abs(residual)), residual, "too long", "too short");
    case "reach":
      return signed(metres(Math.abs(residual)), residual, "too near", "too far");
    case "height":
      return signed(metres(Math.abs(residual)), residual, "too high", "too low");
    case "rssi":
      return signed(`${Math.abs(residual).toFixed(0)} dB`, residual, "too strong", "too weak");
    case "bearing":
      return signed(`${Math.abs((residual * 180) / Math.PI).toFixed(0)}°`, residual, "off", "off");
    case "stillness":
    case "straightness":
      return signed(`${Math.abs((residual * 180) / Math.PI).toFixed(1)} °/s`, residual, "off", "off");
    default:
      return signed(metres(Math.abs(residual)), residual, "off", "off");
  }
}

function signed(amount: string, residual: number, more: string, less: string): string {
  if (Number.parseFloat(amount) === 0) return "fits";
  return `${amount} ${residual > 0 ? more : less}`;
}

/** The best that could be done, in one line; of a variance 40 % is of an error a fifth: no share is said. */
export function adviceWords(advice: Advice, name: (node: string) => string): string {
  const [best, whom] = [advice.suggestions[0], name(advice.node)];
  // Not "±": that is the 95 % radius everywhere on the screen.
  const before = metres(advice.sigma_m);
  const after = best === undefined || best.gain <= 0 ? before : metres(best.sigma_m);
  // Nobody is sent for what nobody would see.
  if (best === undefined || before === after)
    return `Nothing at hand would make ${whom} surer: typical error ${before}.`;
  return `${whoWords(best, name)} would make ${whom} surer: typical error ${after} instead of ${before}.`;
}

function whoWords({ action, by, position_m }: Suggestion, name: (node: string) => string): string {
  if (action === "drop") return by == null ? "A breadcrumb" : `A breadcrumb by ${name(by)}`;
  // The schema's tuples come as arrays.
  const [east, north, up] = position_m as Position;
  const where = `${sideways(east, "E", "W")}, ${sideways(north, "N", "S")}, ${metres(up)} up`;
  return `${by == null ? "A UAV" : name(by)} at ${where}`;
}
