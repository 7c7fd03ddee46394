/** What the whole screen knows: the incident, its pictures now and then, and what is chosen. */
import { alarmByNode, inOrder, type StandingAlarms, standingAlarms } from "../domain/alarms";
import { incidentTime } from "../domain/clock";
import { crewMarks } from "../domain/crews";
import { formatDeepLink, parseDeepLink } from "../domain/deep-link";
import type { LevelChoice } from "../domain/levels";
import { isMoving, limitsOf } from "../domain/staleness";
import { dropMarks, type Extent, extentOf, type Mark, withAlarmMarks, within } from "../domain/timeline";
import { Trails } from "../domain/trails";
import type { DeltaMessage, FrameMessage, Incident, Track } from "../domain/types";
import { nameOf } from "../domain/words";
import * as api from "../sources/api";
import { LiveSource } from "../sources/live-source";
import { ReplaySource } from "../sources/replay-source";
import { applyTheme, firstTheme, THEMES, type Theme } from "../ui/themes";
import { Feed } from "./feed.svelte";

const TICK_MS = 250;
/** Trails are filled with as much of the past when an incident is opened (s). */
const PAST_S = 1800;

export class Screen {
  incidents = $state.raw<readonly Incident[]>([]);
  incident = $state.raw<Incident | null>(null);
  /** Alarms of the live incident, also while its past is looked at. */
  standing = $state.raw<StandingAlarms>(new Map());
  marks = $state.raw<readonly Mark[]>([]);
  mode = $state<"live" | "replay">("live");
  paused = $state(false);
  speed = $state(1);
  level = $state<LevelChoice>("all");
  selected = $state<string | null>(null);
  theme = $state<Theme>(firstTheme());
  trail_s = $state(300);
  signInNeeded = $state(false);
  trouble = $state<string | null>(null);
  /** Local monotonic clock at the last tick (ms). */
  localMs = $state(performance.now());
  readonly trails = new Trails();
  private trackList = $state.raw<readonly Track[]>([]);
  /** First moment of the incident that this screen has seen (Unix s). */
  private earliestT = $state(Number.POSITIVE_INFINITY);
  private replaySource: ReplaySource | null = null;
  /** What the replay's source can seek. */
  private replayExtent: Extent = { from: 0, to: 0 };

  /** The live incident is followed all the time: an alarm must reach whoever looks at the past. */
  private readonly live = new Feed({
    rate: () => (this.incident?.clock === "live" && this.incident.state === "active" ? 1 : 0),
    changed: (message) => this.liveChanged(message),
    heartbeat: () => undefined,
    lost: () => void this.refresh().catch((cause) => this.fail(cause)),
  });
  private readonly replay = new Feed({
    rate: () => (this.paused ? 0 : this.speed),
    changed: () => undefined,
    heartbeat: ({ ended }) => {
      if (ended) this.paused = true;
    },
    lost: () => undefined,
  });

  private readonly feed = $derived(this.mode === "live" ? this.live : this.replay);
  readonly picture = $derived(this.feed.picture);
  readonly link = $derived(this.feed.link);
  /** Incident time (Unix s). */
  readonly now = $derived(incidentTime(this.feed.clock, this.localMs));
  readonly liveNow = $derived(incidentTime(this.live.clock, this.localMs));
  readonly limits = $derived(limitsOf(this.incident));
  readonly levels = $derived(this.incident?.levels ?? []);
  readonly crews = $derived(crewMarks([...(this.picture?.nodes.values() ?? [])].map(({ state }) => state)));
  readonly alarmList = $derived(inOrder(this.standing));
  /** Who is in alarm in what is shown. */
  readonly alarms = $derived(
    alarmByNode(
      this.mode === "live"
        ? this.alarmList.flatMap(({ alarm, cleared }) => (cleared ? [] : [alarm]))
        : (this.picture?.alarms ?? []),
    ),
  );
  readonly extent = $derived<Extent>(
    extentOf(this.incident, this.trackList, this.earliestT, Math.max(this.liveNow, this.now)),
  );
  /** Puts what is shown into the address, so that it can be passed on. */
  readonly address = $derived(
    formatDeepLink({
      incident: this.incident?.id ?? null,
      t: this.mode === "replay" && this.paused ? this.now : null,
      node: this.selected,
      level: this.level,
    }),
  );

  constructor() {
    applyTheme(this.theme);
    setInterval(() => {
      this.localMs = performance.now();
    }, TICK_MS);
  }

  /** Loads the list of incidents and opens the one that the address names, else the newest active one. */
  async begin(): Promise<void> {
    try {
      await this.refresh();
      this.signInNeeded = false;
      const link = parseDeepLink(window.location.hash);
      this.level = link.level;
      const asked = link.incident ?? this.incidents[0]?.id;
      if (asked === undefined) return;
      await this.open(asked, link.t);
      this.selected = link.node;
    } catch (cause) {
      this.fail(cause);
    }
  }

  async refresh(): Promise<void> {
    this.incidents = await api.incidents();
    const current = this.incidents.find(({ id }) => id === this.incident?.id);
    if (current) this.incident = current;
    this.trouble = null;
  }

  /** Shows an incident: live, or from a moment of its past. */
  async open(id: string, t: number | null = null): Promise<void> {
    this.goLive();
    this.incident = await api.incident(id);
    this.standing = new Map();
    this.marks = [];
    this.trackList = [];
    this.selected = null;
    this.trails.clear();
    this.earliestT = Number.POSITIVE_INFINITY;
    this.live.follow(new LiveSource(id));
    if (t !== null) this.replayFrom(t, true);
    await this.fillPast(id);
  }

  /** Back to what is now. */
  goLive(): void {
    this.mode = "live";
    this.paused = false;
    this.speed = 1;
    this.replay.leave();
    this.replaySource = null;
  }

  /** Shows the incident as it was. */
  replayFrom(t: number, paused: boolean): void {
    if (this.incident === null) return;
    const { from, to } = this.extent;
    const begin = Math.min(from, this.incident.first_t ?? from, t);
    const end = Math.max(to, t);
    const at = within({ from: begin, to: end }, t);
    const options = { begin, at, to: end, speed: this.speed, paused };
    this.replayExtent = { from: begin, to: end };
    this.replaySource = new ReplaySource(this.incident.id, options);
    this.replay.follow(this.replaySource);
    this.paused = paused;
    this.mode = "replay";
    this.replay.keepTime(at);
  }

  seek(t: number): void {
    const at = within(this.extent, t);
    // The incident goes on while its past is looked at: what came since needs a wider replay.
    if (this.replaySource === null || within(this.replayExtent, at) !== at) {
      this.replayFrom(at, this.replaySource === null || this.paused);
      return;
    }
    this.replaySource.seek(at);
    this.replay.keepTime(at);
  }

  setPaused(paused: boolean): void {
    if (this.replaySource === null) {
      this.replayFrom(this.now, true);
      return;
    }
    const t = this.now;
    this.paused = paused;
    this.replaySource.setPaused(paused);
    this.replay.keepTime(t);
  }

  setSpeed(speed: number): void {
    const t = this.now;
    this.speed = speed;
    this.replaySource?.setSpeed(speed);
    if (this.replaySource !== null) this.replay.keepTime(t);
  }

  nextTheme(): void {
    this.theme = THEMES[(THEMES.indexOf(this.theme) + 1) % THEMES.length] ?? "day";
    applyTheme(this.theme);
  }

  private liveChanged(message: FrameMessage | DeltaMessage): void {
    const nodes = this.live.picture?.nodes;
    if (message.nodes.length > 0) this.earliestT = Math.min(this.earliestT, message.clock_t);
    this.standing = standingAlarms(this.standing, message.alarms);
    this.marks = withAlarmMarks(this.marks, message.alarms, (node) => {
      const known = nodes?.get(node);
      return known ? nameOf(known.state) : node;
    });
    for (const { node, role, t, position_m } of message.nodes) {
      if (isMoving(role) && position_m != null) this.trails.add(node, t, position_m);
    }
  }

  private async fillPast(id: string): Promise<void> {
    const last = this.incident?.last_t;
    const list = await api.tracks(id, {
      step: 2,
      ...(last == null ? {} : { from: Math.max(0, last - PAST_S) }),
    });
    if (this.incident?.id !== id) return;
    this.trackList = list;
    this.trails.fill(list);
    const crumbs = new Set<string>();
    for (const { state } of this.live.picture?.nodes.values() ?? []) {
      if (state.role === "breadcrumb") crumbs.add(state.node);
    }
    this.marks = [...this.marks, ...dropMarks(list, crumbs)].sort((a, b) => a.t - b.t);
  }

  private fail(cause: unknown): void {
    if (cause instanceof api.RequestFailed && cause.status === 401) this.signInNeeded = true;
    else this.trouble = cause instanceof Error ? cause.message : String(cause);
  }
}
