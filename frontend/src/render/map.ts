/** The map: all layers, from the ground up, on one canvas. */
import type { View } from "../domain/map/view";
import { chain } from "./chain";
import { ellipses } from "./ellipses";
import { grid } from "./grid";
import { known } from "./known";
import { labels } from "./labels";
import type { Layer, Scene } from "./layer";
import { radios } from "./radios";
import { responders } from "./responders";
import { scale } from "./scale";
import { trails } from "./trails";

const LAYERS: readonly Layer[] = [grid, chain, trails, ellipses, radios, responders, known, labels, scale];

/** Draws the newest scene once for each frame of the screen in which it has changed. */
/** A map that has not moved for so long is at rest (ms). */
const AT_REST_MS = 150;

export class MapRenderer {
  /** As it was drawn last. */
  private view: View | null = null;
  /** Runs while the map moves. */
  private rest: ReturnType<typeof setTimeout> | undefined;
  private readonly context: CanvasRenderingContext2D;
  private scene: Scene | null = null;
  private asked = 0;

  constructor(private readonly canvas: HTMLCanvasElement) {
    const context = canvas.getContext("2d", { alpha: false });
    if (context === null) throw new Error("This browser has no canvas: use a current one.");
    this.context = context;
  }

  show(scene: Scene): void {
    this.scene = scene;
    if (this.asked === 0) this.asked = requestAnimationFrame(() => this.draw());
  }

  stop(): void {
    cancelAnimationFrame(this.asked);
    clearTimeout(this.rest);
  }

  private draw(): void {
    this.asked = 0;
    const scene = this.scene;
    if (scene === null) return;
    const ratio = window.devicePixelRatio || 1;
    const width = Math.round(scene.view.width * ratio);
    const height = Math.round(scene.view.height * ratio);
    if (this.canvas.width !== width || this.canvas.height !== height) {
      this.canvas.width = width;
      this.canvas.height = height;
    }
    this.context.setTransform(ratio, 0, 0, ratio, 0, 0);
    if (scene.view !== this.view) this.moves();
    this.view = scene.view;
    for (const layer of LAYERS) layer.draw(this.context, scene, this.rest !== undefined);
  }

  private moves(): void {
    clearTimeout(this.rest);
    this.rest = setTimeout(() => {
      this.rest = undefined;
      if (this.scene !== null) this.show(this.scene);
    }, AT_REST_MS);
  }
}
