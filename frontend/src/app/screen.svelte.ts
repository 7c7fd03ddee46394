/** What the whole screen knows: the incident, its pictures now and then, and what is chosen. */

import { alarmByNode, inOrder } from "../domain/alarms/alarms";
import { blindElsewhere, callsElsewhere } from "../domain/alarms/elsewhere";
import { knownNow } from "../domain/fixes/known-now";
import type { LevelChoice } from "../domain/fixes/levels";
import { isMoving, limitsOf, MOVING, whileUnheard } from "../domain/fixes/staleness";
import { withStoreysAged } from "../domain/fixes/storey-age";
import { Trails, trailsOf } from "../domain/map/trails";
import { lowOnAir } from "../domain/people/air";
import { crewMarks } from "../domain/people/crews";
import { presenceOf } from "../domain/people/presence";
import { type DeepLink, NOTHING } from "../domain/screen/deep-link";
import { incidentTime } from "../domain/time/clock";
import { toldAt } from "../domain/time/stretches";
import { type Extent, extentOf } from "../domain/time/timeline";
import type { DeltaMessage, FrameMessage, Incident, Track } from "../domain/types";
import { nameOf } from "../domain/words";
import * as api from "../sources/api";
import { LiveSource } from "../sources/live-source";
import { applyTheme, firstTheme, THEMES, type Theme } from "../ui/themes";
import { Asking } from "./asking";
import { Door, type DoorOwner } from "./door.svelte";
import { Elsewhere } from "./elsewhere.svelte";
import { Feed } from "./feed.svelte";
import { Marks } from "./marks.svelte";
import { Replay, type ReplayOwner } from "./replay.svelte";
import { Standing } from "./standing.svelte";
import { TracksAround } from "./tracks-around.svelte";

const TICK_MS = 250;
/** Trails are filled with as much of the past when an incident is opened (s). */
const PAST_S = 1800;
/** Centimetres are less than a trail's line is wide, and radios that lie there have none. */
const AS_TRAILS = { view: "live" as const, step: 2, decimals: 2, role: MOVING };
const COMPARED_DECIMALS = 3;

export class Screen implements DoorOwner, ReplayOwner {
  incident = $state.raw<Incident | null>(null);
  /** Alarms of the live incident, also while its past is looked at. */
  readonly standing = new Standing();
  level = $state<LevelChoice>("all");
  selected = $state<string | null>(null);
  theme = $state<Theme>(firstTheme());
  trail_s = $state(300);
  /** Local monotonic clock at the last tick (ms). */
  localMs = $state(performance.now());
  private readonly walked = new Trails();
  readonly marks = new Marks((node) => {
    const known = this.livePicture?.nodes.get(node);
    return known ? nameOf(known.state) : node;
  });
  private trackList = $state.raw<readonly Track[]>([]);
  /** First moment of the incident that this screen has seen (Unix s). */
  private earliestT = $state(Number.POSITIVE_INFINITY);
  /** The incident whose past is read as soon as its present is seen. */
  private pastOf: string | null = null;
  /** The newest entry of the log that is in the live picture. */
  private foldedSeq = $state(0);
  /** What the address named when the page was opened. */
  private readonly wanted = $state.raw<DeepLink>(NOTHING);

  /** The live incident is followed all the time: an alarm must reach whoever looks at the past. */
  private readonly live = new Feed({
    onward: true,
    rate: () => (this.incident?.clock === "live" && this.incident.state === "active" ? 1 : 0),
    changed: (message) => this.liveChanged(message),
    heartbeat: ({ seq }) => {
      this.foldedSeq = seq;
      this.asking.heartbeat(seq);
    },
    lost: () => void this.door.refresh().catch((cause) => this.door.fail(cause)),
    back: () => void this.door.refresh().catch((cause) => this.door.fail(cause)),
  });
  readonly door: Door = new Door(this);
  readonly replay: Replay = new Replay(this);
  readonly compare = new TracksAround((from, to, signal) =>
    api.tracks(this.incident?.id ?? "", { view: "smoothed", from, to, decimals: COMPARED_DECIMALS }, signal),
  );
  /** Where they went before the moment of a replay: what is kept of the present does not reach that far back. */
  private readonly wentThen = new TracksAround((from, to, signal) =>
    api.tracks(this.incident?.id ?? "", { ...AS_TRAILS, from, to }, signal),
  );
  private readonly asking = new Asking(this, this.door);
  private readonly elsewhere = new Elsewhere(
    { active: api.activeIncidents, frame: api.frame },
    this,
    this.door,
  );

  readonly mode = $derived<"live" | "replay">(this.replay.on ? "replay" : "live");
  private readonly feed = $derived(this.replay.shown ? this.replay.feed : this.live);
  /** Incident time (Unix s). */
  readonly now = $derived(incidentTime(this.feed.clock, this.localMs));
  /** The incident as it was set at the moment that is shown. */
  private readonly told = $derived(
    this.replay.shown && this.incident !== null
      ? toldAt(this.incident, this.now, this.feed.picture?.seq ?? 0)
      : this.incident,
  );
  readonly levels = $derived(this.told?.levels ?? []);
  /** The moment that is asked for (Unix s): what is shown, or, until it comes, what was sought. */
  readonly askedT = $derived(this.replay.soughtT ?? this.now);
  readonly liveNow = $derived(incidentTime(this.live.clock, this.localMs));
  readonly picture = $derived(withStoreysAged(this.feed.picture, this.now, this.levels));
  /** As the incident is now, also while its past is looked at: a live alarm has the live place. */
  readonly livePicture = $derived(
    withStoreysAged(this.live.picture, this.liveNow, this.incident?.levels ?? []),
  );
  /** The link that is lost, if one is: of what is shown, or the live one, by which alarms come. */
  readonly lostLink = $derived(
    this.incident === null ? null : ([this.live, this.replay.feed].find((feed) => feed.isLost)?.link ?? null),
  );
  readonly closed = $derived(this.incident?.state === "closed");
  /** It has ended, and what was reported before that is still being worked out: what is shown is not its end. */
  readonly unfinished = $derived(
    this.closed && this.live.picture !== null && this.foldedSeq < (this.incident?.last_seq ?? 0),
  );
  readonly recorded = $derived(this.incident?.clock === "recorded");
  readonly showsPresent = $derived(this.live.picture !== null);
  /** What the live picture tells is of now. */
  readonly liveIsHeard = $derived(
    !this.live.isLost &&
      this.live.picture !== null &&
      !this.live.picture.standsStill &&
      !this.live.picture.behind,
  );
  readonly presence = $derived(
    presenceOf({
      replay: this.replay.shown,
      closed: this.closed,
      recorded: this.recorded,
      heard: this.lostLink === null && this.liveIsHeard,
    }),
  );
  /** It is known who is there: that nobody is must not be said of a picture that has not come. */
  readonly whoIsKnown = $derived(
    this.picture !== null && (this.presence !== "unheard" || this.picture.nodes.size > 0),
  );
  /** Where everybody was at the moment of the past that is shown, as known now; of nobody where that is not wanted. */
  readonly knownNow = $derived(
    knownNow(this.replay.shown ? this.compare.tracks : [], this.picture, this.now, this.levels),
  );
  readonly trails = $derived(
    this.replay.shown && this.wentThen.tracks.length > 0 ? trailsOf(this.wentThen.tracks) : this.walked,
  );
  readonly limits = $derived(
    this.presence === "unheard" ? whileUnheard(limitsOf(this.told)) : limitsOf(this.told),
  );
  readonly crews = $derived(crewMarks([...(this.picture?.nodes.values() ?? [])].map(({ state }) => state)));
  readonly alarmList = $derived(inOrder(this.standing.list));
  /** Whose air is low, as it is known now. */
  readonly lowAir = $derived(
    lowOnAir(
      this.livePicture,
      this.liveNow,
      this.liveIsHeard ? limitsOf(this.incident) : whileUnheard(limitsOf(this.incident)),
    ),
  );
  /** Who is in alarm in what is shown. */
  readonly alarms = $derived(
    alarmByNode(
      this.replay.shown
        ? (this.picture?.alarms ?? [])
        : this.alarmList.flatMap(({ alarm, cleared }) => (cleared ? [] : [alarm])),
    ),
  );
  readonly extent = $derived<Extent>(
    extentOf(
      this.incident,
      this.trackList,
      this.earliestT,
      // A link may lead to the past before anything live has come.
      Math.max(this.liveNow, this.askedT, this.incident?.last_t ?? 0),
    ),
  );
  /** What the address is to name, so that it can be passed on; what was asked for until it is shown. */
  readonly shown = $derived<DeepLink>(
    this.incident === null
      ? this.wanted
      : {
          incident: this.incident.id,
          t: this.replay.on && this.replay.paused ? this.askedT : null,
          node: this.selected,
          level: this.level,
        },
  );
  readonly pastT = $derived(this.replay.on ? this.askedT : null);
  readonly lossIsSaid = $derived(this.lostLink !== null);
  readonly callsElsewhere = $derived(
    callsElsewhere(this.elsewhere.active, this.incident?.id ?? null, this.elsewhere.glimpses),
  );
  readonly blindElsewhere = $derived(
    blindElsewhere(this.elsewhere.active, this.incident?.id ?? null, this.elsewhere.glimpses),
  );
  /** For how long the other incidents have not been heard of (s); null where there is nothing to be said. */
  readonly elsewhereSilentS = $derived(this.lossIsSaid ? null : this.elsewhere.silentS(this.localMs));

  constructor(wanted: DeepLink) {
    this.wanted = wanted;
    void this.elsewhere.begin();
    applyTheme(this.theme);
    setInterval(() => {
      this.localMs = performance.now();
    }, TICK_MS);
  }

  /** Shows an incident, as the link has it. */
  open(incident: Incident, { t, node, level }: DeepLink): void {
    const { id } = incident;
    if (this.incident !== null) this.elsewhere.forget(this.incident.id);
    this.goLive();
    this.incident = incident;
    this.standing.clear();
    this.marks.clear();
    this.marks.told(incident);
    this.trackList = [];
    this.selected = node;
    this.level = level;
    this.walked.clear();
    this.earliestT = Number.POSITIVE_INFINITY;
    this.live.follow(new LiveSource(id));
    if (t !== null) this.replay.begin(t, true);
    this.pastOf = id;
  }

  /** Shows what an address names, without opening the incident again that is open already. */
  travel(link: DeepLink): void {
    if (this.incident === null || link.incident !== this.incident.id) {
      void this.door.follow(link);
      return;
    }
    const { t } = link;
    this.selected = link.node;
    this.level = link.level;
    if (t === this.shown.t) return;
    if (t === null) this.goLive();
    else this.replay.begin(t, true);
  }

  renewed(incident: Incident): void {
    // Closed is for good: an answer that was long on its way does not open it again.
    if (this.closed && incident.state === "active") return;
    this.incident = incident;
    this.marks.told(incident);
  }

  /** Asks for what belongs to the moment that is shown and has not come yet. */
  fetch(): void {
    void this.compare.shows(this.now);
    this.wentThen.on = this.replay.shown;
    void this.wentThen.shows(this.now, this.trail_s);
  }

  /** Back to what is now. */
  goLive(): void {
    this.compare.leave();
    this.wentThen.leave();
    this.replay.end();
  }

  nextTheme(): void {
    this.theme = THEMES[(THEMES.indexOf(this.theme) + 1) % THEMES.length] ?? "day";
    applyTheme(this.theme);
  }

  private liveChanged(message: FrameMessage | DeltaMessage): void {
    if (this.incident !== null && this.pastOf === message.incident) {
      this.pastOf = null;
      void this.readPast(this.incident).catch((cause) => this.door.fail(cause));
    }
    if (message.nodes.length > 0) this.earliestT = Math.min(this.earliestT, message.clock_t);
    this.foldedSeq = message.seq;
    this.standing.heard(message);
    this.marks.seen(message);
    for (const { node, role, t, position_m } of message.nodes) {
      if (isMoving(role) && position_m != null) this.walked.add(node, t, position_m);
    }
  }

  /** What was before comes after what is now: over a slow link it takes many times as long. */
  private async readPast(incident: Incident): Promise<void> {
    // What is in the picture by now was logged before it.
    const marked = this.marks.readPast(incident, Math.max(incident.last_seq, this.livePicture?.seq ?? 0));
    await Promise.all([marked, this.fillPast(incident.id)]);
  }

  private async fillPast(id: string): Promise<void> {
    const last = this.incident?.last_t;
    const list = await api.tracks(id, {
      ...AS_TRAILS,
      ...(last == null ? {} : { from: Math.max(0, last - PAST_S) }),
    });
    if (this.incident?.id !== id) return;
    this.trackList = list;
    this.walked.fill(list);
  }
}
