/**
 * How skin and adipose stretch over an implant or a tissue expander, solved in the browser.
 *
 * An illustration from a simplified model, not a prediction for a person. Units stand in the names of the fields (mm, kPa, N,
 * ml, mmHg); docs/formats.md describes all fields. An invalid input throws an `Error` with one line: field, value and what
 * is allowed.
 *
 * @packageDocumentation
 */

import type { BandsReport } from "./types/bands.js";
import type { BandsSettings } from "./types/bands-options.js";
import type { MapFile, PointFile } from "./types/map.js";
import type { MapOptions as MapChoices } from "./types/map-options.js";
import type { Outcome } from "./types/result.js";
import type { Scene } from "./types/scene.js";
import type { TimesFile } from "./types/times.js";
import load, * as program from "./wasm/implant_preview.js";
import type { InitInput } from "./wasm/implant_preview.js";
import type { Format } from "./types/schemas.js";
import { stream } from "./stream.js";
import type { Pool } from "./stream.js";

export type * from "./types/scene.js";
export type { Outcome as Result, LayerOutcome, ProfilePoint } from "./types/result.js";
export type { MapFile, PointFile } from "./types/map.js";
export type { BandsReport, Band } from "./types/bands.js";
export type { TimesFile, AtTime } from "./types/times.js";
export type { Format } from "./types/schemas.js";

/** How a solve ended. */
export type Status = Outcome["status"];

/** The name of a figure of a result that maps and bands have. */
export type Quantity = MapFile["show"];

/** The place of a scene in the list, from 0, and the scene's `id`, if it has one. */
export interface Place {
  index: number;
  id?: unknown;
}

/** What `simulateMany` yields for a scene: its result, or one line of error. */
export type Line = (Place & Outcome & { error?: undefined }) | (Place & { error: string; status?: undefined });

/** Options of `simulateMany`. */
export interface ManyOptions {
  /**
   * Workers of this call alone, 1 to 64, which end with the call. Default: the workers of the page, one for each core less one,
   * shared by all calls.
   */
  workers?: number;
  /** Lines in the order of the scenes (the default), or each as soon as it is ready. */
  ordered?: boolean;
  /** Ends the call: the generator throws the signal's reason. */
  signal?: AbortSignal;
}

/** A surface of triangles. */
export interface Surface {
  /** Positions of the vertices [mm]: x, y, z of the first one, of the second one, and so on. */
  positions: ArrayLike<number>;
  /** Vertices of the triangles from 0, three of the first one, of the second one, and so on; counter-clockwise seen from outside. */
  triangles: ArrayLike<number>;
}

/** The surface of a body as it was read. */
export interface Body extends Surface {
  positions: Float64Array;
  triangles: Uint32Array;
  /** The unit of the file. */
  unit: "mm" | "cm" | "m";
  /** What was dropped, split or turned, in sentences. */
  notes: string[];
}

/**
 * Points [x, y, z] on a body [mm] by their names: `sternal_notch`, `navel`, `nipple_left`, `nipple_right`, of the side `fold_`, `upper_`,
 * `medial_`, `lateral_` and `left` or `right`; optionally `implant_centre_`.
 */
export type Marks = Record<string, readonly [number, number, number]>;

/** A fitted side of a body. */
export interface FittedBody {
  /** The scene with the implant and the skin of the opening plan; its `body` has the place. */
  scene: Scene;
  quality: {
    /** Shares of a patch of 130 mm without skin, and that determine the chest [%]. */
    no_skin_percent: number;
    data_percent: number;
    /** Radii of the chest at the implant's centre [mm]; null: flat. */
    radius_across_mm: number | null;
    radius_along_mm: number | null;
    /** Root mean square distance of the data from a smooth chest [mm]. */
    residual_mm: number;
    /** Volume between skin and chest in the ellipse of the marks [ml]. */
    footprint_ml: number;
    /** Air under the breast, which counts as tissue [ml]. */
    air_ml: number;
    /** Least, median and greatest thickness of the tissue within 60 mm [mm]. */
    thickness_mm: [number, number, number];
    /** What to check, in sentences. */
    warnings: string[];
  };
}

/** A body over an implant. */
export interface DeformedBody {
  /** Positions of the vertices [mm], in the order of those before. */
  positions: Float64Array;
  result: Outcome;
}

/** Options of `map`: the scene around which the map varies, axes, grid, quantity of the contour lines, whether all points are solved. */
export type MapOptions = MapChoices & { scene: Scene };

/** Options of `bands`: the scene, and what varies. */
export type BandsOptions = BandsSettings & { scene: Scene };

/** A point of a map while the map is solved: `i` along x, `j` along y, from 0. */
export type MapPoint = PointFile & { i: number; j: number };

/**
 * Loads the program; the other functions need it. A second call loads nothing.
 *
 * `wasm`: the program, if it is not beside this module: its address, a response or a compiled module.
 */
export async function init(wasm?: InitInput): Promise<void> {
  await load(wasm === undefined ? undefined : { module_or_path: wasm });
  isLoaded = true;
}

let isLoaded = false;

/** Solves a scene on this thread, which waits. Throws an `Error` of one line for an invalid scene. */
export function simulate(scene: Scene | string): Outcome {
  return JSON.parse(loaded().simulate(textOf(scene)));
}

/** Reads the surface of a body from the content of a file (PLY, STL, OBJ, GLB; 100 MB, 2 million triangles at most), cleaned and in mm. */
export function readBody(content: Uint8Array | ArrayBuffer, name: string): Body {
  return loaded().read_body(content instanceof Uint8Array ? content : new Uint8Array(content), name);
}

/**
 * Fits a side of a body with the marks of a surgeon. `coverMm`: thickness of the tissue beside the breast, half a pinch, 6 to 30; default
 * 10.
 */
export function fitBody(
  { positions, triangles }: Surface,
  marks: Marks,
  side: "left" | "right",
  { coverMm = 10 }: { coverMm?: number } = {},
): FittedBody {
  return JSON.parse(loaded().fit_body(positionsOf(positions), trianglesOf(triangles), JSON.stringify(marks), side, coverMm));
}

/**
 * Solves a scene of `fitBody` on this thread, which waits; returns the vertices of its body over the implant. A vertex outside of the patch
 * keeps its place to the last bit.
 */
export function deform(scene: Scene | string, { positions, triangles }: Surface): DeformedBody {
  const after = loaded().deform(textOf(scene), positionsOf(positions), trianglesOf(triangles));
  return { positions: after.positions, result: JSON.parse(after.result) };
}

/**
 * Solves scenes in workers, for as long as scenes come, in bounded memory: up to eight scenes for each worker are read ahead.
 *
 * Yields a line for each scene. A scene without a result, because it is invalid or stops the program, has `error`; the others
 * go on.
 */
export function simulateMany(
  scenes: Iterable<Scene | string> | AsyncIterable<Scene | string>,
  { workers, ordered = true, signal }: ManyOptions = {},
): AsyncGenerator<Line, void, void> {
  const pool = loaded().workers() as Pool;
  if (workers !== undefined && !(Number.isInteger(workers) && workers >= 1 && workers <= 64)) {
    throw new Error(`workers is ${workers}; allowed: 1 to 64`);
  }
  return stream<Scene | string, Line>(scenes, {
    pool: workers === undefined ? pool : pool.withWorkers(workers),
    isOwn: workers !== undefined,
    ordered,
    signal,
    job: (scene) => ({ kind: "simulate", scene: textOf(scene) }),
    line: (scene, index, answer) => ({ index, ...idOf(scene), ...answer }) as Line,
  });
}

/**
 * Solves a map in workers: one or two numbers of a scene varied over a grid. `onPoint` receives each point as it comes, from
 * coarse to fine.
 */
export function map(
  options: MapOptions,
  { onPoint = () => {}, signal }: { onPoint?: (point: MapPoint) => void; signal?: AbortSignal } = {},
): Promise<MapFile> {
  return study(signal, () => loaded().map(JSON.stringify(options), (point) => onPoint(JSON.parse(point))));
}

/** Solves bands in workers: a result over what is not known about a person. `onProgress` receives numbers of scenes. */
export function bands(
  options: BandsOptions,
  { onProgress = () => {}, signal }: { onProgress?: (done: number, all: number) => void; signal?: AbortSignal } = {},
): Promise<BandsReport> {
  return study(signal, () => loaded().bands(JSON.stringify(options), onProgress));
}

/**
 * Solves a scene of layered tissue in workers, on the table, a week and six months after its operation. `onProgress` receives numbers of
 * scenes.
 */
export function times(
  scene: Scene | string,
  { onProgress = () => {}, signal }: { onProgress?: (done: number, all: number) => void; signal?: AbortSignal } = {},
): Promise<TimesFile> {
  return study(signal, () => loaded().times(textOf(scene), onProgress));
}

/** The plan that the app opens with: an implant of 12 cm and 225 ml, pinch 2 cm, normal skin, the usual chest. */
export function openingScene(): Scene {
  return JSON.parse(loaded().opening_scene());
}

/** The scene of the defaults: a hemisphere of 55 mm under layered tissue over a flat chest. */
export function defaultScene(): Scene {
  return JSON.parse(loaded().default_scene());
}

/** The JSON Schema of a format, a scene unless another is named. */
export async function schema(of: Format = "scene"): Promise<Record<string, unknown>> {
  const { schemas } = await import("./types/schemas.js");
  if (!Object.hasOwn(schemas, of)) throw new Error(`${of} is no format; allowed: ${Object.keys(schemas).join(", ")}`);
  return schemas[of];
}

/** The version of the program. */
export function version(): string {
  return loaded().version();
}

/** Ends the workers of the page and all calls in them; a later call starts new workers. */
export function terminate(): void {
  (loaded().workers() as Pool).terminate();
}

function loaded(): typeof program {
  if (!isLoaded) throw new Error("the program is not loaded; allowed: calls after `await init()`");
  return program;
}

function textOf(scene: Scene | string): string {
  return typeof scene === "string" ? scene : JSON.stringify(scene);
}

function positionsOf(values: ArrayLike<number>): Float64Array {
  return values instanceof Float64Array ? values : Float64Array.from(values);
}

function trianglesOf(values: ArrayLike<number>): Uint32Array {
  return values instanceof Uint32Array ? values : Uint32Array.from(values);
}

/** The `id` of a scene, if it has one. */
function idOf(scene: Scene | string): { id?: unknown } {
  try {
    const value = typeof scene === "string" ? JSON.parse(scene) : scene;
    return value?.id === undefined ? {} : { id: value.id };
  } catch {
    return {};
  }
}

/** Runs a study; an aborted signal cancels it. */
async function study<T>(
  signal: AbortSignal | undefined,
  start: () => { cancel(): void; done: Promise<string> },
): Promise<T> {
  signal?.throwIfAborted();
  const { cancel, done } = start();
  signal?.addEventListener("abort", cancel);
  try {
    return JSON.parse(await done);
  } catch (error) {
    signal?.throwIfAborted();
    throw error;
  } finally {
    signal?.removeEventListener("abort", cancel);
  }
}
