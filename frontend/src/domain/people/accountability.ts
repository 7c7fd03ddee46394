/** The accountability board: every responder by crew, in the order that does not jump about. */

import { storeyUnsure, storeyWords } from "../fixes/levels";
import { ageS, covarianceAt, type StalenessLimits, statusAt, toldAt } from "../fixes/staleness";
import { ce95 } from "../map/ellipse";
import type { Picture } from "../picture";
import type { FrameAlarm, FrameNode, Level, Status } from "../types";
import { airWords, alarmWord, isOld, nameOf, statusWord } from "../words";
import { airStateWords, isLowOnAir } from "./air";

export interface BoardRow {
  readonly node: string;
  readonly name: string;
  readonly status: Status;
  readonly statusWord: string;
  readonly level: string;
  readonly levelUnsure: boolean;
  readonly age_s: number;
  readonly error_m: number | null;
  readonly air: string;
  /** The report of it is too old to be taken for what is so now. */
  readonly airOld: boolean;
  /** What is said beside it: that it is low, or time to turn back. */
  readonly airState: string | null;
  readonly airLow: boolean;
  readonly alarm: string | null;
  readonly state: FrameNode;
}

export interface BoardCrew {
  readonly crew: string;
  readonly rows: readonly BoardRow[];
}

export interface BoardCounts {
  readonly responders: number;
  readonly live: number;
  readonly stale: number;
  readonly lost: number;
  readonly left: number;
}

const NO_CREW = "No crew";
const UAVS = "UAV";

/** Rows by crew: named crews in order of name, then those without one, then aircraft; of the past, or at the end, or now. */
export function board(
  picture: Picture | null,
  now: number,
  levels: readonly Level[],
  limits: StalenessLimits,
  alarms: ReadonlyMap<string, FrameAlarm>,
  ofThen = false,
): BoardCrew[] {
  const crews = new Map<string, BoardRow[]>();
  for (const sighting of picture?.nodes.values() ?? []) {
    const { state } = sighting;
    if (state.role !== "responder" && state.role !== "uav") continue;
    const status = statusAt(state, now, limits);
    const covariance = covarianceAt(sighting, now);
    const alarm = alarms.get(state.node);
    const airTold = toldAt(state.air_t, status, now, limits);
    const row: BoardRow = {
      node: state.node,
      name: nameOf(state),
      status,
      statusWord: statusWord(status, ofThen),
      level: storeyWords(state, levels),
      levelUnsure: storeyUnsure(state),
      age_s: ageS(state, now),
      error_m: covariance && ce95(covariance),
      air: airWords(state.air_bar, airTold),
      airOld: isOld(airTold),
      airState: status === "retired" ? null : airStateWords(state.air_state),
      airLow: isLowOnAir(state),
      alarm: alarm ? alarmWord(alarm.alarm) : null,
      state,
    };
    const crew = state.role === "uav" ? UAVS : state.crew || NO_CREW;
    const rows = crews.get(crew);
    if (rows) rows.push(row);
    else crews.set(crew, [row]);
  }
  return [...crews]
    .map(([crew, rows]) => ({ crew, rows: rows.sort(byName) }))
    .sort((a, b) => crewRank(a.crew) - crewRank(b.crew) || byNumber(a.crew, b.crew));
}

/** How many responders there are, and how many of them are live, stale, lost or have left. */
export function boardCounts(crews: readonly BoardCrew[]): BoardCounts {
  const counts = { responders: 0, live: 0, stale: 0, lost: 0, left: 0 };
  for (const { rows } of crews) {
    for (const { state, status } of rows) {
      if (state.role !== "responder") continue;
      if (status === "retired") {
        counts.left += 1;
        continue;
      }
      counts.responders += 1;
      counts[status] += 1;
    }
  }
  return counts;
}

/** The names of the responders who are nowhere on the map, but for those of whom it is known why. */
export function withoutFix(crews: readonly BoardCrew[], why: ReadonlyMap<string, string>): string[] {
  return crews
    .flatMap(({ rows }) => rows)
    .filter(({ node, state, status }) => {
      return state.role === "responder" && status !== "retired" && !state.position_m && !why.has(node);
    })
    .map(({ name }) => name);
}

/** Radios that stand: how many, and the names of those that moved or fell silent. */
export interface RadioCounts {
  readonly breadcrumbs: number;
  readonly others: number;
  readonly silent: readonly string[];
  readonly moved: readonly string[];
}

export function radioCounts(picture: Picture | null, now: number, limits: StalenessLimits): RadioCounts {
  let breadcrumbs = 0;
  let others = 0;
  const silent: string[] = [];
  const moved: string[] = [];
  for (const { state } of picture?.nodes.values() ?? []) {
    if (state.role === "responder" || state.role === "uav") continue;
    const status = statusAt(state, now, limits);
    if (status === "retired") continue;
    if (state.role === "breadcrumb") breadcrumbs += 1;
    else others += 1;
    if (status !== "live") silent.push(nameOf(state));
    if (state.moved) moved.push(nameOf(state));
  }
  return { breadcrumbs, others, silent, moved };
}

/** The next (+1) or previous (-1) responder on the board after the selected one, going round. */
export function neighbourOnBoard(
  crews: readonly BoardCrew[],
  selected: string | null,
  step: 1 | -1,
): string | null {
  const nodes = crews.flatMap(({ rows }) => rows.map((row) => row.node));
  if (nodes.length === 0) return null;
  const index = selected === null ? -1 : nodes.indexOf(selected);
  const from = index === -1 && step === -1 ? 0 : index;
  return nodes[(from + step + nodes.length) % nodes.length] ?? null;
}

/** The next responder of that status after the selected one, going round: who is lost must be found among fifty. */
export function nextOfStatus(
  crews: readonly BoardCrew[],
  selected: string | null,
  status: Status,
): string | null {
  const rows = crews.flatMap((crew) => crew.rows);
  const after = rows.findIndex(({ node }) => node === selected) + 1;
  const found = [...rows.slice(after), ...rows.slice(0, after)].find(
    (row) => row.state.role === "responder" && row.status === status,
  );
  return found?.node ?? null;
}

function crewRank(crew: string): number {
  return crew === UAVS ? 2 : crew === NO_CREW ? 1 : 0;
}

function byName(a: BoardRow, b: BoardRow): number {
  return byNumber(a.name, b.name);
}

/** "Engine 9" before "Engine 10". */
function byNumber(a: string, b: string): number {
  return a.localeCompare(b, undefined, { numeric: true });
}
