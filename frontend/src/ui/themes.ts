/** Day, dusk and night: one palette each, for the canvas and, as custom properties, for the panels. */

export type Theme = "day" | "dusk" | "night";
export const THEMES: readonly Theme[] = ["day", "dusk", "night"];

export interface Palette {
  /** Whether its grounds are light or dark: thin lines in a crew's colour differ. */
  readonly shade: "light" | "dark";
  /** Ground of the map. */
  readonly ground: string;
  readonly panel: string;
  readonly raised: string;
  readonly ink: string;
  readonly inkSoft: string;
  /** Borders of controls. */
  readonly line: string;
  readonly grid: string;
  readonly gridStrong: string;
  readonly accent: string;
  readonly accentInk: string;
  /** Ground of what is chosen, which is there all the time: by night it shines no more than it must. */
  readonly chosen: string;
  readonly chosenInk: string;
  /** Red: alarm, and nothing else. */
  readonly alarm: string;
  readonly alarmInk: string;
  /** Warnings that are no alarm. */
  readonly warn: string;
  readonly radio: string;
}

export const PALETTES: Record<Theme, Palette> = {
  day: {
    shade: "light",
    ground: "#eef1f4",
    panel: "#ffffff",
    raised: "#e6ebef",
    ink: "#14202b",
    inkSoft: "#465462",
    line: "#6f7f8d",
    grid: "#dbe1e6",
    gridStrong: "#c2ccd5",
    accent: "#0b5f96",
    accentInk: "#ffffff",
    chosen: "#0b5f96",
    chosenInk: "#ffffff",
    alarm: "#b80f26",
    alarmInk: "#ffffff",
    warn: "#7a4b00",
    radio: "#4a5a68",
  },
  dusk: {
    shade: "dark",
    ground: "#202933",
    panel: "#29343f",
    raised: "#364350",
    ink: "#e3e8ec",
    inkSoft: "#b4c0ca",
    line: "#8797a5",
    grid: "#2a3540",
    gridStrong: "#3a4753",
    accent: "#7cc4ee",
    accentInk: "#10202c",
    chosen: "#7cc4ee",
    chosenInk: "#10202c",
    alarm: "#c81f36",
    alarmInk: "#ffffff",
    warn: "#f0c060",
    radio: "#a9b8c4",
  },
  night: {
    shade: "dark",
    ground: "#090d11",
    panel: "#10161c",
    raised: "#1b242d",
    ink: "#cfd7de",
    inkSoft: "#98a6b3",
    line: "#61717f",
    grid: "#141b22",
    gridStrong: "#222c36",
    accent: "#5fb0de",
    accentInk: "#081018",
    chosen: "#1d4e6c",
    chosenInk: "#e3ebf1",
    alarm: "#c01c33",
    alarmInk: "#ffffff",
    warn: "#d9a441",
    radio: "#8496a5",
  },
};

const KEPT_AS = "firethread.theme";

/** The theme chosen before, else what the system asks for. */
export function firstTheme(): Theme {
  const kept = localStorage.getItem(KEPT_AS);
  if (THEMES.includes(kept as Theme)) return kept as Theme;
  return matchMedia("(prefers-color-scheme: dark)").matches ? "night" : "day";
}

/** Puts a theme on the page, and keeps the choice. */
export function applyTheme(theme: Theme): void {
  const root = document.documentElement;
  for (const [name, colour] of Object.entries(PALETTES[theme])) root.style.setProperty(`--${name}`, colour);
  root.dataset.theme = theme;
  root.style.colorScheme = theme === "day" ? "light" : "dark";
  localStorage.setItem(KEPT_AS, theme);
}
