// web/serve.py: what it sends to a browser, and to clients without compression.

import assert from "node:assert/strict";
import { spawn } from "node:child_process";
import { once } from "node:events";
import { existsSync, readdirSync, readFileSync, statSync } from "node:fs";
import { request } from "node:http";
import { connect } from "node:net";
import { join } from "node:path";
import { after, before, describe, test } from "node:test";
import { brotliDecompressSync, gunzipSync } from "node:zlib";
import * as harness from "./harness.mjs";

const DECODE = { br: brotliDecompressSync, gzip: gunzipSync, undefined: (bytes) => bytes };
const SUFFIX = { br: ".br", gzip: ".gz", undefined: "" };

const isCopy = (file) => /\.(br|gz)$/.test(file);
const isFile = (file) => statSync(join(harness.DIST, file)).isFile();
const files = () =>
  readdirSync(harness.DIST, { recursive: true }).filter((file) => !file.startsWith(".") && isFile(file));
const wasmFile = () => files().find((file) => file.endsWith(".wasm"));

/** Status, headers and body of an answer, as sent. */
async function ask(address, { method = "GET", encodings } = {}) {
  const headers = encodings === undefined ? {} : { "Accept-Encoding": encodings };
  const [response] = await once(request(address, { method, headers }).end(), "response");
  const body = Buffer.concat(await response.toArray());
  return { status: response.statusCode, headers: response.headers, body };
}

describe("web/serve.py", { timeout: 4 * harness.PATIENCE }, () => {
  let server;
  let address;
  before(async () => {
    server = spawn("python3", [join(harness.ROOT, "web/serve.py"), harness.DIST, "8790"]);
    const [line] = await once(server.stdout, "data");
    [address] = String(line).match(/http:\S+/);
  });
  after(() => server.kill());

  test("sends every file, compressed if the client accepts that, with its type and length", async () => {
    assert.ok(existsSync(join(harness.DIST, `${wasmFile()}.br`)), "the build has no compressed copies");
    for (const file of files().filter((file) => !isCopy(file))) {
      const bytes = readFileSync(join(harness.DIST, file));
      const [type] = harness.TYPES[file.match(/\.\w+$/)[0]].split(";");
      for (const [encodings, preferred] of [
        ["gzip, deflate, br, zstd", ["br", "gzip"]],
        ["gzip, deflate", ["gzip"]],
        ["br;q=0, gzip;q=0.5", ["gzip"]],
        ["GZIP ; q=1", ["gzip"]],
        ["br; q=0.0,gzip;q=0", []],
        ["identity", []],
        ["", []],
        [undefined, []],
      ]) {
        const name = `${file}, Accept-Encoding: ${encodings}`;
        const expected = preferred.find((encoding) => existsSync(join(harness.DIST, file + SUFFIX[encoding])));
        const { status, headers, body } = await ask(address + file, { encodings });
        assert.equal(status, 200, name);
        assert.equal(headers["content-encoding"], expected, name);
        assert.equal(headers["content-type"], type, name);
        assert.equal(Number(headers["content-length"]), body.length, name);
        assert.equal(headers.vary, "Accept-Encoding", name);
        assert.ok(DECODE[expected](body).equals(bytes), name);
        const head = await ask(address + file, { method: "HEAD", encodings });
        assert.equal(head.status, 200, name);
        assert.equal(head.body.length, 0, name);
        for (const field of ["content-encoding", "content-type", "content-length", "vary"]) {
          assert.equal(head.headers[field], headers[field], `${name}, HEAD, ${field}`);
        }
      }
    }
  });

  test("sends the page for the address of its folder", async () => {
    const { headers, body } = await ask(`${address}?a=b`, { encodings: "br" });
    assert.equal(headers["content-encoding"], "br");
    assert.equal(headers["content-type"], "text/html");
    assert.deepEqual(brotliDecompressSync(body), readFileSync(join(harness.DIST, "index.html")));
  });

  test("refuses what is not in the folder", async () => {
    /** The first line of the answer to a path as it is: clients resolve dots. */
    const raw = async (path) => {
      const socket = connect(new URL(address).port, "127.0.0.1");
      socket.end(`GET ${path} HTTP/1.0\r\nAccept-Encoding: br, gzip\r\n\r\n`);
      return Buffer.concat(await socket.toArray()).toString("latin1");
    };
    assert.match(await raw("/index.html"), /^HTTP\/1\.0 200 /);
    for (const path of [
      "/../README.md",
      "/%2e%2e/README.md",
      "/..%2fREADME.md",
      "/build/../../README.md",
      "//README.md",
      "/none",
    ]) {
      const answer = await raw(path);
      assert.match(answer, /^HTTP\/1\.0 404 /, path);
      assert.doesNotMatch(answer, /content-encoding|implant-preview/i, path);
    }
  });

  test("sends the program to Chromium as brotli, and the bar of the download has a total", async () => {
    const browser = await harness.startBrowser();
    try {
      const { page, finish } = await harness.openPage(browser, address, {
        init: () => {
          globalThis.shown = [];
          new MutationObserver(() => {
            const text = document.getElementById("loading-text")?.textContent;
            if (text && text !== shown.at(-1)) shown.push(text);
          }).observe(document, { childList: true, subtree: true, characterData: true });
        },
      });
      await page.waitForFunction(() => globalThis.implantPreview?.stats().converged);
      const file = wasmFile();
      const sent = await page.evaluate(async (file) => {
        const response = await fetch(file, { cache: "reload" });
        const bytes = new Uint8Array(await response.arrayBuffer());
        const digest = new Uint8Array(await crypto.subtle.digest("SHA-256", bytes));
        return { encoding: response.headers.get("Content-Encoding"), length: bytes.length, digest: [...digest] };
      }, file);
      const bytes = readFileSync(join(harness.DIST, file));
      assert.equal(sent.encoding, "br");
      assert.equal(sent.length, bytes.length);
      assert.deepEqual(sent.digest, [...new Uint8Array(await crypto.subtle.digest("SHA-256", bytes))]);
      const total = (bytes.length / 1e6).toFixed(1);
      const shown = await page.evaluate(() => globalThis.shown);
      assert.ok(shown.includes(`Loading the preview: ${total} of ${total} MB`), shown.join("\n"));
      await finish();
    } finally {
      await browser.close();
    }
  });
});
