// Type-checked against the installed package (tsc --strict), and run in the browser as JavaScript: uses each function.

import * as ip from "implant-preview";
import type { BandsReport, Body, DeformedBody, FittedBody, Line, MapFile, MapPoint, Marks, Result, Scene, TimesFile } from "implant-preview";

export async function useAll() {
  await ip.init();
  await ip.init();
  const scene: Scene = { ...ip.defaultScene(), insertion: 0.8, solver: { nodes_per_side: 17, tolerance: 1e-3 } };
  const opening: Scene = ip.openingScene();
  const result: Result = ip.simulate(scene);
  const force: number | null = result.contact_force_n;
  const fromText: Result = ip.simulate(JSON.stringify(scene));
  const points: MapPoint[] = [];
  const map: MapFile = await ip.map(
    { scene, x: { field: "insertion", from: 0.5, to: 1, count: 3 }, show: "force_n" },
    { onPoint: (point) => points.push(point) },
  );
  const progress: [number, number][] = [];
  const bands: BandsReport = await ip.bands(
    {
      scene: { ...scene, tissue_model: "sheet" },
      samples: 16,
      importance_rows: 0,
      unknowns: { projection: null, skin_thickness: { log_normal: { median: 1.5, gsd: 1.2 } } },
    },
    { onProgress: (done, all) => progress.push([done, all]) },
  );
  const times: TimesFile = await ip.times(scene, { onProgress: (done, all) => progress.push([done, all]) });
  const later: number | undefined = times.times[2].values.force_n?.value;
  const lines: Line[] = [];
  for await (const line of ip.simulateMany([scene, JSON.stringify({ ...scene, insertion: 7 })], { workers: 1 })) {
    lines.push(line);
  }
  const forces = lines.map((line) => (line.error === undefined ? line.contact_force_n : line.error));
  return { opening, result, force, fromText, map, points, bands, progress, times, later, forces, schema: await ip.schema(), version: ip.version() };
}

/** Reads a body, fits its left side, solves the scene on it and at rest. */
export async function useBody(content: Uint8Array, name: string, marks: Marks) {
  await ip.init();
  const body: Body = ip.readBody(content, name);
  const fitted: FittedBody = ip.fitBody(body, marks, "left", { coverMm: 10 });
  const scene: Scene = { ...fitted.scene, solver: { nodes_per_side: 33, tolerance: 1e-3 } };
  const after: DeformedBody = ip.deform(scene, body);
  const rest: DeformedBody = ip.deform(JSON.stringify({ ...scene, insertion: 0 }), body);
  const [radius, unit]: [number | null, "mm" | "cm" | "m"] = [fitted.quality.radius_across_mm, body.unit];
  const line = (run: () => unknown): string => {
    try {
      return JSON.stringify(run());
    } catch (error) {
      return `${error}`;
    }
  };
  const { positions, triangles } = body;
  const refused = [
    line(() => ip.readBody(new Uint8Array([1, 2, 3]), "body.ply")),
    line(() => ip.fitBody({ positions: positions.subarray(1), triangles }, marks, "left")),
    line(() => ip.fitBody({ positions, triangles: [0, 1, -1] }, marks, "left")),
    line(() => ip.fitBody({ positions, triangles: [] }, marks, "left")),
    line(() => ip.fitBody({ positions: Array.from(positions, () => NaN), triangles }, marks, "left")),
    line(() => ip.fitBody(body, { navel: [0, 0, 0] }, "left")),
    line(() => ip.fitBody(body, marks, "middle" as "left")),
    line(() => ip.fitBody(body, marks, "left", { coverMm: 3 })),
    line(() => ip.deform(ip.openingScene(), body)),
  ];
  const plain = (values: ArrayLike<number>) => Array.from(values);
  return {
    positions: plain(positions),
    triangles: plain(triangles),
    unit,
    notes: body.notes,
    radius,
    fitted,
    after: plain(after.positions),
    status: after.result.status,
    rest: plain(rest.positions),
    refused,
  };
}

/** What the types refuse: an error that is missing is an error of this file. */
export async function refused() {
  const scene = ip.defaultScene();
  // @ts-expect-error an unknown field
  scene.colour = "red";
  // @ts-expect-error text instead of a number
  scene.insertion = "0.8";
  // @ts-expect-error an unknown field of a part
  scene.solver = { nodes: 17 };
  // @ts-expect-error an unknown kind of curve
  scene.layers = [{ tissue: "skin", curve: { kind: "steel" } }];
  // @ts-expect-error the implant is missing
  ip.simulate({ insertion: 1 });
  const result = ip.simulate(scene);
  // @ts-expect-error an unknown field of a result
  result.force;
  // @ts-expect-error may be null
  result.contact_force_n.toFixed(2);
  // @ts-expect-error a status that does not exist
  result.status === "done";
  // @ts-expect-error an axis without its ends
  await ip.map({ scene, x: { field: "insertion", count: 3 } });
  // @ts-expect-error an unknown quantity
  await ip.map({ scene, x: { field: "insertion", from: 0, to: 1, count: 3 }, show: "colour" });
  // @ts-expect-error an unknown field of times
  (await ip.times(scene)).times[0].force_n;
  // @ts-expect-error an unknown distribution
  await ip.bands({ scene, unknowns: { projection: { normal: { mean: 0 } } } });
  for await (const line of ip.simulateMany([scene])) {
    // @ts-expect-error a line may be an error
    line.contact_force_n;
  }
  // @ts-expect-error a number instead of a scene
  ip.simulateMany([5]);
  // @ts-expect-error an unknown format
  await ip.schema("moon");
  // @ts-expect-error an unknown option
  ip.simulateMany([scene], { threads: 2 });
  const body = ip.readBody(new Uint8Array(), "body.ply");
  // @ts-expect-error an unknown side
  ip.fitBody(body, {}, "middle");
  // @ts-expect-error a mark of two numbers
  ip.fitBody(body, { navel: [0, 0] }, "left");
  // @ts-expect-error a surface without triangles
  ip.deform(scene, { positions: body.positions });
}
