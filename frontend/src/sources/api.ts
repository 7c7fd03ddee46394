/** Requests to the server, with their answers as values. */
import createClient from "openapi-fetch";
import type { Advice, Evidence, Frame, FrameAlarm, Incident, Role, Track } from "../domain/types";
import type { components, paths } from "./schema";

const client = createClient<paths>({ baseUrl: window.location.origin });

/** What kept a request from being done: `status` is the HTTP status, 0 where no answer came. */
export class RequestFailed extends Error {
  constructor(
    readonly status: number,
    message: string,
  ) {
    super(message);
  }
}

type Problem = components["schemas"]["Problem"];

/** A look into another incident that takes longer than this is given up (ms). */
const LOOK_WITHIN_MS = 5000;
/**
 * What somebody waits for and takes longer is given up, to be asked for again (ms): of a connection that is lost
 * without a word a browser hears nothing for minutes, and meanwhile no other alarm could be answered.
 */
const ANSWER_WITHIN_MS = 10_000;

/** Who speaks in batches sent from this screen. */
const GATEWAY = "command-post";

async function answered<T>(
  request: Promise<{ data?: T; error?: Problem | undefined; response: Response }>,
): Promise<T> {
  let answer: Awaited<typeof request>;
  try {
    answer = await request;
  } catch (cause) {
    throw new RequestFailed(0, whyUnanswered(cause));
  }
  if (!answer.response.ok) {
    const problem = answer.error;
    const said = problem?.detail || problem?.title || answer.response.statusText;
    throw new RequestFailed(answer.response.status, said || `The server answered ${answer.response.status}.`);
  }
  return answer.data as T;
}

function whyUnanswered(cause: unknown): string {
  if (cause instanceof DOMException && cause.name === "TimeoutError") return "The server does not answer.";
  return `The server cannot be reached (${cause instanceof Error ? cause.message : cause}).`;
}

function within(ms: number): { signal: AbortSignal } {
  return { signal: AbortSignal.timeout(ms) };
}

/** All incidents, the newest first, active ones before closed ones. */
export async function incidents(): Promise<Incident[]> {
  const list = await answered(client.GET("/api/v1/incidents", within(ANSWER_WITHIN_MS)));
  return list.sort(
    (a, b) => Number(a.state === "closed") - Number(b.state === "closed") || b.created - a.created,
  );
}

/** The incidents that are not closed. Asked for again and again: a request that hangs must make room. */
export async function activeIncidents(): Promise<Incident[]> {
  const params = { query: { state: "active" as const } };
  return answered(client.GET("/api/v1/incidents", { params, ...within(LOOK_WITHIN_MS) }));
}

/** What is known of an incident now. */
export async function frame(id: string): Promise<Frame> {
  const asked = { params: { path: { incident: id } }, ...within(LOOK_WITHIN_MS) };
  return (await answered(client.GET("/api/v1/incidents/{incident}/frame", asked))) as Frame;
}

export async function incident(id: string): Promise<Incident> {
  const asked = { params: { path: { incident: id } }, ...within(ANSWER_WITHIN_MS) };
  return answered(client.GET("/api/v1/incidents/{incident}", asked));
}

/**
 * Where everybody was, a point every `step` seconds between `from` and `to` (Unix s), with so many decimals of its
 * numbers, and only those of some roles: `live` as the estimate stood then, `smoothed` with everything known now.
 */
export async function tracks(
  id: string,
  query: {
    view: "live" | "smoothed";
    from?: number;
    to?: number;
    step?: number;
    decimals: number;
    role?: Role[];
  },
  signal?: AbortSignal,
): Promise<Track[]> {
  const params = { path: { incident: id }, query };
  // openapi-fetch widens the tuples of the schema to arrays.
  const request = client.GET("/api/v1/incidents/{incident}/tracks", { params, ...(signal && { signal }) });
  return (await answered(request)).tracks as Track[];
}

/** What holds a node's fix at `t` (Unix s; null: the newest), with everything known now. */
export async function evidence(
  id: string,
  node: string,
  t: number | null,
  signal: AbortSignal,
): Promise<Evidence> {
  const params = { path: { incident: id }, query: { node, ...(t === null ? {} : { t }) } };
  return (await answered(
    client.GET("/api/v1/incidents/{incident}/evidence", { params, signal }),
  )) as Evidence;
}

/** What would make a node's newest position surer. */
export async function advice(id: string, node: string, signal: AbortSignal): Promise<Advice> {
  const params = { path: { incident: id }, query: { node } };
  return (await answered(client.GET("/api/v1/incidents/{incident}/advice", { params, signal }))) as Advice;
}

/**
 * Puts the commander's word on an alarm into the log, and gives the entry in which it is.
 * `batch` makes it safe to send again.
 */
export async function postAlarm(
  id: string,
  batch: string,
  t: number,
  alarm: FrameAlarm,
  state: FrameAlarm["state"],
): Promise<number> {
  const said = { kind: "alarm" as const, t, node: alarm.node, alarm: alarm.alarm, state };
  const answer = await answered(
    client.POST("/api/v1/incidents/{incident}/telemetry", {
      params: { path: { incident: id } },
      body: { gateway: GATEWAY, batch, readings: [said] },
      ...within(ANSWER_WITHIN_MS),
    }),
  );
  const refused = answer.rejected[0];
  if (refused) throw new RequestFailed(422, refused.message);
  return answer.seq;
}

/** Trades an access token for a session cookie. */
export async function signIn(token: string): Promise<void> {
  await answered(client.POST("/api/v1/session", { body: { token }, ...within(ANSWER_WITHIN_MS) }));
}

/** A batch id that no other screen will choose. `crypto.randomUUID` exists only on secure origins. */
export function freshBatch(): string {
  const bytes = crypto.getRandomValues(new Uint8Array(16));
  return [...bytes].map((byte) => byte.toString(16).padStart(2, "0")).join("");
}
