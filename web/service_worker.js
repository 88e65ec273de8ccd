// Keeps the page for use without a network.
//
// Each build has a worker of its own, with a cache of its own, which is stored completely or not at all. With a network the
// entries (HTML, manifest, icons) come from the network, so that a reload has the newest build. The files of a build lie in a
// folder named by its content; they come from the cache. Nothing else is stored: no plan, no result.

// Written by pack.mjs: the folder of the build, and the addresses of its files and of the entries.
const BUILD = "";
const FILES = [];

const SCOPE = registration.scope;
// Other pages of this origin have caches too.
const PREFIX = `implant-preview ${SCOPE} `;
const CACHE = PREFIX + BUILD;

/** Downloads a file for the cache. */
async function download(file) {
  const response = await fetch(file, { cache: "no-cache" });
  if (!response.ok) throw new Error(`${file}: the server answered ${response.status}`);
  // The server may have a newer build by now: its pages and modules name another folder.
  const isNaming = file === "./" || /^[^/]+\.(html|mjs)$/.test(file);
  if (isNaming && !(await response.clone().text()).includes(BUILD)) {
    throw new Error(`${file} is a file of another build`);
  }
  // Browsers refuse a redirected response to a navigation.
  return response.redirected ? new Response(response.body, response) : response;
}

/** Stores the build. */
async function store() {
  try {
    const cache = await caches.open(CACHE);
    await Promise.all(FILES.map(async (file) => cache.put(file, await download(file))));
  } catch (error) {
    await caches.delete(CACHE);
    throw error;
  }
  // The older worker would answer with the older build when the network fails.
  await skipWaiting();
}

/** Removes older builds and serves the open pages. */
async function begin() {
  const old = (await caches.keys()).filter((name) => name.startsWith(PREFIX) && name !== CACHE);
  await Promise.all(old.map((name) => caches.delete(name)));
  await clients.claim();
}

async function stored(file) {
  return (await caches.open(CACHE)).match(file, { ignoreVary: true });
}

async function networkFirst(request, file) {
  try {
    // The browser's own cache may be old.
    return await fetch(request, { cache: "no-cache" });
  } catch (error) {
    const response = await stored(file);
    if (response) return response;
    throw error;
  }
}

async function cacheFirst(request, file) {
  return (await stored(file)) ?? fetch(request);
}

addEventListener("install", (event) => event.waitUntil(store()));
addEventListener("activate", (event) => event.waitUntil(begin()));
addEventListener("fetch", (event) => {
  const { request } = event;
  const [address] = request.url.split(/[?#]/);
  if (request.method !== "GET" || !address.startsWith(SCOPE)) return;
  const path = address.slice(SCOPE.length);
  const file = path === "" || path === "index.html" ? "./" : path;
  // Files of other builds among others come from the network.
  if (!FILES.includes(file)) return;
  event.respondWith(file.startsWith(`${BUILD}/`) ? cacheFirst(request, file) : networkFirst(request, file));
});
