/** What the whole screen knows: the incident, its pictures now and then, and what is chosen. */
import { alarmByNode, inOrder, type StandingAlarms, standingAlarms } from "../domain/alarms";
import { incidentTime } from "../domain/clock";
import { crewMarks } from "../domain/crews";
import { type DeepLink, formatDeepLink } from "../domain/deep-link";
import type { LevelChoice } from "../domain/levels";
import { presenceOf } from "../domain/presence";
import { isMoving, limitsOf, whileUnheard } from "../domain/staleness";
import { type Extent, extentOf, within } from "../domain/timeline";
import { Trails } from "../domain/trails";
import type { DeltaMessage, FrameMessage, Incident, Track } from "../domain/types";
import { nameOf } from "../domain/words";
import * as api from "../sources/api";
import { LiveSource } from "../sources/live-source";
import { ReplaySource } from "../sources/replay-source";
import { applyTheme, firstTheme, THEMES, type Theme } from "../ui/themes";
import { Asking, type AskingOwner } from "./asking";
import { Feed } from "./feed.svelte";
import { Marks } from "./marks.svelte";

const TICK_MS = 250;
const NOTHING: DeepLink = { incident: null, t: null, node: null, level: "all" };
/** Trails are filled with as much of the past when an incident is opened (s). */
const PAST_S = 1800;

export class Screen implements AskingOwner {
  incidents = $state.raw<readonly Incident[]>([]);
  incident = $state.raw<Incident | null>(null);
  /** Alarms of the live incident, also while its past is looked at. */
  standing = $state.raw<StandingAlarms>(new Map());
  mode = $state<"live" | "replay">("live");
  paused = $state(false);
  speed = $state(1);
  level = $state<LevelChoice>("all");
  selected = $state<string | null>(null);
  theme = $state<Theme>(firstTheme());
  trail_s = $state(300);
  signInNeeded = $state(false);
  trouble = $state<string | null>(null);
  /** Only a person can tell what to show instead. */
  deadLink = false;
  /** Local monotonic clock at the last tick (ms). */
  localMs = $state(performance.now());
  readonly trails = new Trails();
  readonly marks = new Marks((node) => {
    const known = this.livePicture?.nodes.get(node);
    return known ? nameOf(known.state) : node;
  });
  private trackList = $state.raw<readonly Track[]>([]);
  /** First moment of the incident that this screen has seen (Unix s). */
  private earliestT = $state(Number.POSITIVE_INFINITY);
  private replaySource: ReplaySource | null = null;
  private wanted = $state.raw<DeepLink>(NOTHING);
  /** An attempt to load what the address names is under way. */
  private beginning = false;
  /** What the replay's source can seek. */
  private replayExtent: Extent = { from: 0, to: 0 };

  /** The live incident is followed all the time: an alarm must reach whoever looks at the past. */
  private readonly live = new Feed({
    rate: () => (this.incident?.clock === "live" && this.incident.state === "active" ? 1 : 0),
    changed: (message) => this.liveChanged(message),
    heartbeat: ({ seq }) => this.asking.heartbeat(seq),
    lost: () => void this.refresh().catch((cause) => this.fail(cause)),
    back: () => void this.refresh().catch((cause) => this.fail(cause)),
  });
  private readonly asking = new Asking(this);
  private readonly replay = new Feed({
    rate: () => (this.paused ? 0 : this.speed),
    changed: () => undefined,
    heartbeat: ({ ended }) => {
      if (ended) this.paused = true;
    },
    lost: () => undefined,
    back: () => undefined,
  });

  private readonly feed = $derived(this.mode === "live" ? this.live : this.replay);
  readonly picture = $derived(this.feed.picture);
  /** As the incident is now, also while its past is looked at: a live alarm has the live place. */
  readonly livePicture = $derived(this.live.picture);
  /** The link that is lost, if one is: of what is shown, or the live one, by which alarms come. */
  readonly lostLink = $derived(
    this.incident === null
      ? null
      : ([this.live, this.feed].find((feed) => feed.isLost(this.localMs))?.link ?? null),
  );
  readonly closed = $derived(this.incident?.state === "closed");
  readonly presence = $derived(
    presenceOf({
      replay: this.mode === "replay",
      closed: this.closed,
      heard: this.lostLink === null && this.live.picture !== null,
    }),
  );
  /** Incident time (Unix s). */
  readonly now = $derived(incidentTime(this.feed.clock, this.localMs));
  readonly liveNow = $derived(incidentTime(this.live.clock, this.localMs));
  readonly limits = $derived(
    this.presence === "unheard" ? whileUnheard(limitsOf(this.incident)) : limitsOf(this.incident),
  );
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
    extentOf(
      this.incident,
      this.trackList,
      this.earliestT,
      // A link may lead to the past before anything live has come.
      Math.max(this.liveNow, this.now, this.incident?.last_t ?? 0),
    ),
  );
  /** What the address is to name, so that it can be passed on; what was asked for until it is shown. */
  readonly shown = $derived<DeepLink>(
    this.incident === null
      ? this.wanted
      : {
          incident: this.incident.id,
          t: this.mode === "replay" && this.paused ? this.now : null,
          node: this.selected,
          level: this.level,
        },
  );
  readonly address = $derived(formatDeepLink(this.shown));

  /** @param wanted what the address named when the page was opened */
  constructor(wanted: DeepLink) {
    this.wanted = wanted;
    applyTheme(this.theme);
    setInterval(() => {
      this.localMs = performance.now();
    }, TICK_MS);
  }

  /** Loads the list of incidents and opens the one that the address names, else the newest active one. */
  async begin(): Promise<void> {
    if (this.beginning) return;
    this.beginning = true;
    const link = this.shown;
    try {
      await this.refresh();
      this.signInNeeded = false;
      await this.follow({ ...link, incident: link.incident ?? this.incidents[0]?.id ?? null });
    } catch (cause) {
      this.fail(cause);
    } finally {
      this.beginning = false;
    }
  }

  /** Shows what a link names; nothing new where it names no incident. */
  async follow(link: DeepLink): Promise<void> {
    try {
      if (link.incident !== null) await this.open(link.incident, link);
    } catch (cause) {
      this.deadLink = cause instanceof api.RequestFailed && cause.status === 404;
      this.fail(cause);
    }
  }

  async refresh(): Promise<void> {
    const list = await api.incidents();
    this.incidents = list;
    const current = list.find(({ id }) => id === this.incident?.id);
    if (current) this.incident = current;
    this.trouble = null;
  }

  /** Shows an incident as it is now, on all storeys. */
  choose(id: string): Promise<void> {
    return this.follow({ ...NOTHING, incident: id });
  }

  private async open(id: string, { t, node, level }: DeepLink): Promise<void> {
    const incident = await api.incident(id);
    this.goLive();
    this.trouble = null;
    this.incident = incident;
    this.standing = new Map();
    this.marks.clear();
    this.trackList = [];
    this.selected = node;
    this.level = level;
    this.trails.clear();
    this.earliestT = Number.POSITIVE_INFINITY;
    this.live.follow(new LiveSource(id));
    if (t !== null) this.replayFrom(t, true);
    await this.fillPast(id);
    if (this.incident.id === id) void this.marks.readPast(id, this.incident.last_seq);
  }

  renewed(incident: Incident): void {
    this.incident = incident;
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
    const begin = Math.max(0, Math.min(from, this.incident.first_t ?? from, t));
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
    if (message.nodes.length > 0) this.earliestT = Math.min(this.earliestT, message.clock_t);
    this.standing = standingAlarms(message.alarms);
    this.marks.alarms(message.alarms);
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
    this.marks.drops(list, crumbs);
  }

  fail(cause: unknown): void {
    const status = cause instanceof api.RequestFailed ? cause.status : null;
    if (status === 401) this.signInNeeded = true;
    // That the server cannot be reached is said over everything already.
    else if (status !== 0 || this.lostLink === null)
      this.trouble = cause instanceof Error ? cause.message : String(cause);
  }
}
