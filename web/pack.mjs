// Run by trunk after a build, after name_module.sh: completes the files for a server.
//
// 1. All files but the entries go into one folder, which is named by the content of the build: a page takes every file from
//    the folder that its HTML names, so that no page mixes files of two builds, whatever a server or a cache has.
// 2. index.html receives the size of the program, service_worker.js the list of files.
// 3. Compressed copies (.br, .gz) stand beside the files: some 15 s for a changed program.

import { createHash } from "node:crypto";
import {
  cpSync,
  existsSync,
  mkdirSync,
  readdirSync,
  readFileSync,
  renameSync,
  rmSync,
  statSync,
  writeFileSync,
} from "node:fs";
import { dirname, extname, join } from "node:path";
import { promisify } from "node:util";
import * as zlib from "node:zlib";
import { brotliOf, GZIP } from "./compression.mjs";

const STAGING = process.env.TRUNK_STAGING_DIR;
const LAST = process.env.TRUNK_DIST_DIR;

/** Files with an address of their own. The first ones name files of the folder. */
const NAMING = ["index.html", "bench.html", "implant-preview.mjs"];
const ENTRIES = [...NAMING, "favicon.svg", "icon-192.png", "icon-512.png", "manifest.webmanifest", "service_worker.js"];

const COMPRESSED = new Set([".css", ".html", ".js", ".mjs", ".svg", ".wasm", ".webmanifest"]);

const brotli = promisify(zlib.brotliCompress);
const gzip = promisify(zlib.gzip);
const ENCODINGS = [
  {
    suffix: ".br",
    encode: (bytes) => brotli(bytes, brotliOf(bytes)),
    decode: zlib.brotliDecompressSync,
  },
  { suffix: ".gz", encode: (bytes) => gzip(bytes, GZIP), decode: zlib.gunzipSync },
];

const inStaging = (file) => join(STAGING, file);

/** The files of a folder and of the folders in it, as sorted paths with slashes. */
function filesOf(folder, base = "") {
  const entries = readdirSync(join(folder, base), { withFileTypes: true });
  const files = entries.flatMap((entry) => {
    const path = base + entry.name;
    return entry.isDirectory() ? filesOf(folder, `${path}/`) : [path];
  });
  return files.sort();
}

/** Replaces a text of a file that has to occur once. */
function replaceOnce(file, from, to) {
  const parts = readFileSync(inStaging(file), "utf8").split(from);
  if (parts.length !== 2) throw new Error(`pack.mjs: ${file} has ${parts.length - 1} times, not once: ${from}`);
  writeFileSync(inStaging(file), parts.join(to));
}

/** Moves all files but the entries into a folder named by the content. Returns its name and the files in it. */
function moveFiles() {
  const all = filesOf(STAGING);
  const missing = ENTRIES.filter((entry) => !all.includes(entry));
  if (missing.length > 0) throw new Error(`pack.mjs: the build has no ${missing.join(", ")}`);
  const hash = createHash("sha256");
  for (const file of all) {
    const bytes = readFileSync(inStaging(file));
    hash.update(`${file}\0${bytes.length}\0`).update(bytes);
  }
  const build = `build-${hash.digest("hex").slice(0, 16)}`;
  const moved = all.filter((file) => !ENTRIES.includes(file));
  for (const file of moved) {
    mkdirSync(dirname(inStaging(`${build}/${file}`)), { recursive: true });
    renameSync(inStaging(file), inStaging(`${build}/${file}`));
  }
  // The benchmark's page imports this module from its own folder.
  cpSync(inStaging("implant-preview.mjs"), inStaging(`${build}/implant-preview.mjs`));
  for (const folder of new Set(moved.filter((file) => file.includes("/")).map((file) => file.split("/")[0]))) {
    rmSync(inStaging(folder), { recursive: true });
  }
  for (const file of NAMING) {
    const text = readFileSync(inStaging(file), "utf8");
    const named = text.replace(/"(?:\.\/)?([^"\s]+)"/g, (whole, path) =>
      moved.includes(path) ? `"./${build}/${path}"` : whole,
    );
    writeFileSync(inStaging(file), named);
  }
  return { build, files: filesOf(inStaging(build)).map((file) => `${build}/${file}`) };
}

/** Writes the compressed copies of a file. A copy of the last build is used again if it decodes to the same bytes. */
async function compress(file, last) {
  const bytes = readFileSync(inStaging(file));
  for (const { suffix, encode, decode } of ENCODINGS) {
    const older = last.get(file.replace(/^build-\w+\//, "") + suffix);
    const packed = older && decode(older).equals(bytes) ? older : await encode(bytes);
    if (packed.length < bytes.length) writeFileSync(inStaging(file + suffix), packed);
  }
}

/** The compressed copies of the last build by their path within the folder of that build. */
function lastCopies() {
  if (!LAST || !existsSync(LAST)) return new Map();
  const copies = filesOf(LAST).filter((file) => !file.startsWith(".") && /\.(br|gz)$/.test(file));
  return new Map(copies.map((file) => [file.replace(/^build-\w+\//, ""), readFileSync(join(LAST, file))]));
}

const { build, files } = moveFiles();

const wasm = files.find((file) => extname(file) === ".wasm");
const size = statSync(inStaging(wasm)).size;
replaceOnce("index.html", `data-wasm="./${wasm}"`, `data-wasm="./${wasm}" data-wasm-bytes="${size}"`);

// The address of index.html is that of the folder. The worker itself is no file of its cache.
const kept = ENTRIES.filter((entry) => entry !== "index.html" && entry !== "service_worker.js");
replaceOnce("service_worker.js", 'const BUILD = "";', `const BUILD = ${JSON.stringify(build)};`);
const list = JSON.stringify(["./", ...kept, ...files], null, 2);
replaceOnce("service_worker.js", "const FILES = [];", `const FILES = ${list};`);

const last = lastCopies();
const texts = filesOf(STAGING).filter((file) => COMPRESSED.has(extname(file)));
await Promise.all(texts.map((file) => compress(file, last)));
