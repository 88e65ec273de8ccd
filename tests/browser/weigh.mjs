// What weighs what in the page: the sections of the program, the fonts in its data, and what a visit downloads.
//
// node tests/browser/weigh.mjs [FOLDER]: on its own, for dist unless another folder of a build is named. Takes some 30 s.

import { existsSync, readdirSync, readFileSync, statSync } from "node:fs";
import { join } from "node:path";
import { fileURLToPath } from "node:url";
import { brotliCompressSync, brotliDecompressSync, gzipSync } from "node:zlib";
import { brotliOf, GZIP } from "../../web/compression.mjs";

const DIST = fileURLToPath(new URL("../../dist", import.meta.url));

const SECTIONS = "custom type import function table memory global export start element code data data-count tag".split(
  " ",
);

const gzip = (bytes) => gzipSync(bytes, GZIP);
const brotli = (bytes) => brotliCompressSync(bytes, brotliOf(bytes));

/** The files that a server sends, as paths in the folder of a build. */
export function files(folder = DIST) {
  const isSent = (file) => !file.startsWith(".") && !/\.(br|gz)$/.test(file) && statSync(join(folder, file)).isFile();
  return readdirSync(folder, { recursive: true }).filter(isSent).sort();
}

/** The size of a file as brotli: that of its compressed copy, which has to decode to the file, or its own. */
export function brotliSize(file) {
  const bytes = readFileSync(file);
  if (!existsSync(`${file}.br`)) return brotli(bytes).length;
  const copy = readFileSync(`${file}.br`);
  if (!brotliDecompressSync(copy).equals(bytes)) throw new Error(`${file}.br is not a copy of the file`);
  return copy.length;
}

/** Reads numbers of the variable length of WebAssembly. */
class Reader {
  constructor(bytes, at = 0) {
    this.bytes = bytes;
    this.at = at;
  }

  number() {
    let value = 0;
    for (let shift = 1; ; shift *= 128) {
      const byte = this.bytes[this.at++];
      value += (byte & 127) * shift;
      if (byte < 128) return value;
    }
  }

  take(length) {
    this.at += length;
    return this.bytes.subarray(this.at - length, this.at);
  }
}

/** The sections of a program: name and content. */
function sections(wasm) {
  const found = [];
  for (const reader = new Reader(wasm, 8); reader.at < wasm.length;) {
    const kind = reader.take(1)[0];
    const content = reader.take(reader.number());
    const inner = new Reader(content);
    const name = kind === 0 ? `custom ${inner.take(inner.number())}` : SECTIONS[kind];
    found.push({ name, content });
  }
  return found;
}

/** The memory at the start from the first segment on. Fonts may span segments: tools split the data at zeros. */
function memoryImage(data) {
  const reader = new Reader(data);
  const segments = [];
  for (let left = reader.number(); left > 0; left -= 1) {
    const kind = reader.number();
    const isActive = kind !== 1;
    if (kind === 2) reader.number();
    // i32.const OFFSET end
    if (isActive && reader.take(1)[0] !== 0x41) return Buffer.alloc(0);
    const offset = isActive ? reader.number() : 0;
    if (isActive) reader.take(1);
    const bytes = reader.take(reader.number());
    if (isActive) segments.push({ offset, bytes });
  }
  if (segments.length === 0) return Buffer.alloc(0);
  const first = Math.min(...segments.map(({ offset }) => offset));
  const end = Math.max(...segments.map(({ offset, bytes }) => offset + bytes.length));
  const image = Buffer.alloc(end - first);
  for (const { offset, bytes } of segments) image.set(bytes, offset - first);
  return image;
}

/** The name of a font (name 4 or 1 of its table of names), or null. */
function fontName(font, table) {
  const count = font.readUInt16BE(table + 2);
  const texts = table + font.readUInt16BE(table + 4);
  const names = new Map();
  for (let record = table + 6; record < table + 6 + 12 * count; record += 12) {
    const [platform, , , id, length, offset] = [0, 2, 4, 6, 8, 10].map((k) => font.readUInt16BE(record + k));
    const bytes = Buffer.from(font.subarray(texts + offset, texts + offset + length));
    if (!names.has(id)) names.set(id, platform === 1 ? bytes.toString("latin1") : bytes.swap16().toString("utf16le"));
  }
  return names.get(4) ?? names.get(1) ?? null;
}

/** The TrueType and OpenType fonts in a memory image: name and content. */
function fonts(image) {
  const found = [];
  const isTag = (at) => /^[A-Za-z0-9/ ]{4}$/.test(image.toString("latin1", at, at + 4));
  for (let at = 0; at + 12 < image.length; at += 1) {
    const version = image.readUInt32BE(at);
    if (version !== 0x00010000 && version !== 0x4f54544f) continue;
    const count = image.readUInt16BE(at + 4);
    if (count < 4 || count > 40 || at + 12 + 16 * count > image.length) continue;
    const tables = Array.from({ length: count }, (_, k) => at + 12 + 16 * k);
    if (!tables.every(isTag)) continue;
    const parts = tables.map((table) => ({
      tag: image.toString("latin1", table, table + 4),
      offset: image.readUInt32BE(table + 8),
      length: image.readUInt32BE(table + 12),
    }));
    const length = Math.max(...parts.map((part) => part.offset + part.length));
    if (at + length > image.length) continue;
    const content = image.subarray(at, at + length);
    const names = parts.find(({ tag }) => tag === "name");
    found.push({ name: `  font ${(names && fontName(content, names.offset)) ?? "without a name"}`, content });
    at += length - 1;
  }
  return found;
}

function main() {
  const folder = process.argv[2] ?? DIST;
  const line = (name, ...sizes) =>
    console.log(name.padEnd(44) + sizes.map((size) => String(size).padStart(12)).join(""));
  const row = (name, bytes) => line(name, bytes.length, gzip(bytes).length, brotli(bytes).length);
  const all = files(folder);
  const program = all.find((file) => file.endsWith(".wasm"));
  line("[bytes]", "raw", "gzip", "brotli");
  const wasm = readFileSync(join(folder, program));
  // Each part is compressed alone: the sum is not the total.
  for (const { name, content } of sections(wasm)) {
    row(name, content);
    if (name === "data") for (const font of fonts(memoryImage(content))) row(font.name, font.content);
  }
  line("program", wasm.length, gzip(wasm).length, brotliSize(join(folder, program)));
  console.log();
  const total = [0, 0, 0];
  const page = readFileSync(join(folder, "index.html"), "utf8");
  // What index.html names, and what its scripts import.
  const isLoaded = (file) => page.includes(`./${file}"`) || file === "index.html" || /\/(crash|form)\.js$/.test(file);
  for (const file of all.filter(isLoaded)) {
    const bytes = readFileSync(join(folder, file));
    const sizes = [bytes.length, gzip(bytes).length, brotliSize(join(folder, file))];
    sizes.forEach((size, k) => (total[k] += size));
    line(file.split("/").at(-1), ...sizes);
  }
  line("first visit", ...total);
}

if (process.argv[1] === fileURLToPath(import.meta.url)) main();
