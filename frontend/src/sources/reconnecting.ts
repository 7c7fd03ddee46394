/** A socket that comes back: after a close, and after silence. */
import type { DeltaMessage, FrameMessage, HeartbeatMessage, LiveMessage } from "../domain/types";
import { backoffMs } from "./backoff";
import { Sleep } from "./sleep";
import { type LinkState, type Listener, NOT_CONNECTED, type Source } from "./source";

/** The server sends at least a heartbeat every 2 s; silence longer than this is a lost connection. */
export const SILENCE_MS = 5000;
const WATCH_EVERY_MS = 500;

/** A message that tells a moment: `clock_t` of a picture, `t` of a heartbeat. */
export type Told = FrameMessage | DeltaMessage | HeartbeatMessage;

/** A Source over a WebSocket of live messages; what differs between sources is the address. */
export class ReconnectingSource implements Source {
  private readonly listeners = new Set<Listener>();
  private socket: WebSocket | null = null;
  private retry: ReturnType<typeof setTimeout> | undefined;
  private readonly watch = setInterval(() => this.noticeSilence(), WATCH_EVERY_MS);
  private state: LinkState = NOT_CONNECTED;
  private connectingSinceMs = 0;
  private readonly sleep = new Sleep(Date.now(), performance.now());
  private readonly online = () => this.reconnectNow();

  /** @param address asked for anew before each attempt */
  constructor(private readonly address: () => string) {
    window.addEventListener("online", this.online);
    this.connect();
  }

  subscribe(listener: Listener): () => void {
    this.listeners.add(listener);
    listener.state(this.state);
    return () => this.listeners.delete(listener);
  }

  close(): void {
    clearTimeout(this.retry);
    clearInterval(this.watch);
    window.removeEventListener("online", this.online);
    this.drop();
    this.become({ ...this.state, link: "closed" });
    this.listeners.clear();
  }

  /** Tries at once instead of waiting for the backoff; does nothing while the link is open. */
  reconnectNow(): void {
    if (this.state.link === "open" || this.state.link === "closed") return;
    this.drop();
    this.connect();
  }

  protected send(message: object): void {
    if (this.socket?.readyState === WebSocket.OPEN) this.socket.send(JSON.stringify(message));
  }

  /** Called when the link has opened, before any message. */
  protected opened(): void {}

  /** Whether a message of `t` (Unix s) is of what was asked for at all; called with each. */
  protected concerns(_type: Told["type"], _t: number): boolean {
    return true;
  }

  /** Incident time by a message of `t` (Unix s), or null: it tells none; called with each. */
  protected time(_type: Told["type"], t: number): number | null {
    return t;
  }

  private connect(): void {
    clearTimeout(this.retry);
    this.connectingSinceMs = performance.now();
    const socket = new WebSocket(this.address());
    this.socket = socket;
    socket.onopen = () => this.opened();
    socket.onmessage = (event) => this.receive(JSON.parse(String(event.data)) as LiveMessage);
    socket.onclose = () => this.lost();
  }

  private receive(message: LiveMessage): void {
    this.become({ link: "open", lastWordMs: performance.now(), attempts: 0 });
    if (message.type === "error") return;
    const of = message.type === "heartbeat" ? message.t : message.clock_t;
    if (!this.concerns(message.type, of)) return;
    const t = this.time(message.type, of);
    for (const listener of this.listeners) {
      if (message.type === "frame") listener.frame(message, t);
      else if (message.type === "delta") listener.delta(message, t);
      else listener.heartbeat(message, t);
    }
  }

  private noticeSilence(): void {
    const sleptMs = this.sleep.since(Date.now(), performance.now());
    if (sleptMs > 0) this.awoke(sleptMs);
    if (this.socket === null) return;
    const since = Math.max(this.state.lastWordMs ?? 0, this.connectingSinceMs);
    if (performance.now() - since > SILENCE_MS) {
      this.drop();
      this.lost();
    }
  }

  /** What came before the device slept is as old as that, whatever the monotonic clock says of it. */
  private awoke(sleptMs: number): void {
    const { lastWordMs } = this.state;
    this.drop();
    this.become({
      ...this.state,
      link: "lost",
      lastWordMs: lastWordMs === null ? null : lastWordMs - sleptMs,
    });
    this.connect();
  }

  private lost(): void {
    this.socket = null;
    const attempts = this.state.attempts + 1;
    this.become({ ...this.state, link: "lost", attempts });
    clearTimeout(this.retry);
    this.retry = setTimeout(() => this.connect(), backoffMs(attempts - 1, Math.random()));
  }

  /** Forgets the socket without hearing of its close. */
  private drop(): void {
    const socket = this.socket;
    this.socket = null;
    if (socket === null) return;
    socket.onopen = socket.onmessage = socket.onclose = null;
    socket.close();
  }

  private become(state: LinkState): void {
    const told = state.link !== this.state.link || state.attempts !== this.state.attempts;
    this.state = state;
    // A word every 100 ms changes nothing that anyone waits for, save the time of the last one.
    if (told || state.link === "open") for (const listener of this.listeners) listener.state(state);
  }
}

/** The WebSocket address of a path on the server that this page came from. */
export function socketAddress(path: string): string {
  const scheme = window.location.protocol === "https:" ? "wss:" : "ws:";
  return `${scheme}//${window.location.host}${path}`;
}
