// Writes the JSON Schemas of the formats, and TypeScript types made from them: node types.mjs FOLDER PROGRAM

import { execFileSync } from "node:child_process";
import { mkdirSync, writeFileSync } from "node:fs";
import { join } from "node:path";
import { compile } from "json-schema-to-typescript";

const FORMATS = ["scene", "result", "map", "map-options", "bands", "bands-options", "times"];

const [folder, program] = process.argv.slice(2);
mkdirSync(folder, { recursive: true });
/** Marks a schema that allows any value: without the mark its type would be an object. */
const marked = (name, schema) =>
  Object.keys(schema ?? {}).join() === "description" ? { ...schema, tsType: "unknown" } : schema;

const schemas = {};
for (const format of FORMATS) {
  const json = execFileSync(program, ["schema", "--of", format], { encoding: "utf8" });
  schemas[format] = JSON.parse(json);
  const text = await compile(JSON.parse(json, marked), schemas[format].title, {
    additionalProperties: false, // unless the schema allows others
    bannerComment: `// From the JSON Schema: implant-preview schema --of ${format}`,
    format: false,
  });
  writeFileSync(join(folder, `${format}.d.ts`), text);
}
const names = FORMATS.map((format) => JSON.stringify(format)).join(" | ");
const types = `/** A format with a schema. */
export type Format = ${names};
/** The JSON Schemas. */
export declare const schemas: Record<Format, Record<string, unknown>>;
`;
writeFileSync(join(folder, "schemas.d.ts"), types);
writeFileSync(join(folder, "schemas.js"), `export const schemas = ${JSON.stringify(schemas)};\n`);
