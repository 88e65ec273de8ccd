// What the page promises when something goes wrong, each tried in the real browser: what is entered
// stays here, a lost picture or a crash costs no work, a hidden tab rests.

import assert from "node:assert/strict";
import { describe, test } from "node:test";
import * as harness from "./harness.mjs";

const fixture = harness.setUp({ isPlain: true });
const { openApp } = fixture;
const { sceneText } = harness;

/** Records what the page's policy forbids, in `violations`. */
function watchPolicy() {
  globalThis.violations = [];
  addEventListener("securitypolicyviolation", (event) => {
    violations.push(`${event.effectiveDirective} ${event.blockedURI}`);
  });
}

/** Tries what a script from elsewhere would; returns what of it was done. */
async function attack() {
  globalThis.done = [];
  const start = (address) =>
    new Promise((resolve, reject) => {
      const worker = new Worker(address, { type: "module" });
      worker.onmessage = () => resolve(done.push(`a worker from ${address}`));
      worker.onerror = reject;
    });
  const attempts = {
    script: () => {
      const script = document.createElement("script");
      script.textContent = "done.push('an inline script')";
      document.head.append(script);
    },
    "a script with the fixed nonce of old": () => {
      const script = document.createElement("script");
      script.nonce = "implant-preview";
      script.textContent = "done.push('a script with a nonce')";
      document.head.append(script);
    },
    handler: () => {
      const button = document.createElement("button");
      button.setAttribute("onclick", "done.push('an inline handler')");
      document.body.append(button);
      button.click();
      button.remove();
    },
    // Not at once: what the driver of the test runs may use it.
    eval: () => setTimeout(() => eval("done.push('eval')")),
    style: () => {
      const block = document.createElement("div");
      block.setAttribute("style", "position: fixed");
      document.body.append(block);
      if (getComputedStyle(block).position === "fixed") done.push("an inline style");
      block.remove();
    },
    image: () =>
      new Promise((resolve) => {
        const image = new Image();
        image.onload = () => resolve(done.push("an image"));
        image.onerror = resolve;
        image.src = "data:image/gif;base64,R0lGODlhAQABAAAAACwAAAAAAQABAAA=";
      }),
    request: () => fetch("http://localhost:9/").then(() => done.push("a request")),
    beacon: () => navigator.sendBeacon("http://localhost:9/", "scene"),
    worker: () => start(URL.createObjectURL(new Blob(["postMessage(1)"], { type: "text/javascript" }))),
    "a worker from data": () => start("data:text/javascript,postMessage(1)"),
    "a worker from elsewhere": () => start("http://localhost:9/worker.mjs"),
  };
  for (const attempt of Object.values(attempts)) {
    try {
      await attempt();
    } catch {
      // It was refused.
    }
  }
  await new Promise((resolve) => setTimeout(resolve, 200));
  return { done, blocked: [...new Set(violations.map((violation) => violation.split(" ")[0]))].sort() };
}

const BLOCKED = [
  "connect-src",
  "img-src",
  "script-src",
  "script-src-attr",
  "script-src-elem",
  "style-src-attr",
  "worker-src",
];

describe("the policy of the page", { timeout: 6 * harness.PATIENCE }, () => {
  test("is kept while scenes are opened, solved and saved; all comes from the page's own place", async () => {
    const { page, finish } = await openApp({ init: watchPolicy });
    const opened = JSON.parse(await sceneText(page));
    opened.insertion = 0.5;
    const [chooser] = await Promise.all([page.waitForEvent("filechooser"), page.keyboard.press("Control+o")]);
    // The dialog's own style sheet is let through.
    const dialog = page.locator("#rfd-overlay");
    assert.equal(await dialog.evaluate((element) => getComputedStyle(element).position), "fixed");
    await chooser.setFiles({
      name: "half.json",
      mimeType: "application/json",
      buffer: Buffer.from(JSON.stringify(opened)),
    });
    await page.waitForFunction(() => JSON.parse(implantPreview.scene()).insertion === 0.5);
    await harness.focusPicture(page);
    await page.keyboard.press("4");
    const saved = await harness.download(page, () => page.keyboard.press("Control+s"));
    assert.match(saved.name, /^implant-\d+ml-\d{4}-\d\d-\d\d\.json$/);
    assert.equal(JSON.parse(saved.text).insertion, 0.5);
    await page.waitForFunction(() => implantPreview.stats().converged);
    const names = await page.evaluate(() => performance.getEntriesByType("resource").map((r) => r.name));
    assert.ok(names.some((name) => name.endsWith(".wasm")), names.join());
    assert.deepEqual(names.filter((name) => !name.startsWith(fixture.site.address) && !name.startsWith("blob:")), []);
    assert.deepEqual(await page.evaluate(() => violations), []);
    await finish();
  });

  for (const [name, path] of [
    ["app", ""],
    ["benchmark", "bench.html"],
  ]) {
    test(`stops foreign scripts, styles and requests in the ${name}'s page`, async () => {
      const { page, close } = await fixture.openPage(path, { init: watchPolicy });
      assert.equal(await page.locator("script:not([src]), style, [onclick]").count(), 0);
      const { done, blocked } = await page.evaluate(attack);
      assert.deepEqual(done, []);
      assert.deepEqual(blocked, BLOCKED);
      await close();
    });
  }
});

describe("a lost WebGL context", { timeout: 6 * harness.PATIENCE }, () => {
  const lose = (page) =>
    page.evaluate(async () => {
      const canvas = document.getElementById("implant-preview-canvas");
      globalThis.loss = canvas.getContext("webgl2").getExtension("WEBGL_lose_context");
      const lost = new Promise((resolve) => canvas.addEventListener("webglcontextlost", resolve, { once: true }));
      loss.loseContext();
      await lost;
    });
  const restore = (page) =>
    page.evaluate(async () => {
      const canvas = document.getElementById("implant-preview-canvas");
      const restored = new Promise((resolve) =>
        canvas.addEventListener("webglcontextrestored", resolve, { once: true }),
      );
      loss.restoreContext();
      await restored;
    });
  // Without the line that says how long a frame took.
  const picture = async (page) => {
    await page.mouse.move(640, 790);
    await harness.settled(page);
    return page.screenshot({ clip: { x: 0, y: 0, width: 1280, height: 750 } });
  };
  const drag = async (page, [x, y], [toX, toY]) => {
    await page.mouse.move(x, y);
    await harness.settled(page);
    await page.mouse.down();
    await page.waitForTimeout(200);
    await page.mouse.move(toX, toY, { steps: 4 });
    await page.waitForTimeout(200);
    await page.mouse.up();
  };

  test("gives back the same picture: scene, history, camera, colours, panels; nothing is solved anew", async () => {
    const { page, finish } = await openApp({ isPlain: false, isResearch: true });
    const seen = [await picture(page)];
    // Each of these must show in the picture, or the test would prove nothing.
    const change = async (name, act) => {
      await act();
      const now = await picture(page);
      assert.ok(seen.every((before) => !before.equals(now)), `${name} does not show`);
      const pixels = await harness.difference(page, seen.at(-1), now);
      assert.ok(pixels > 100, `${name} does not show: ${pixels} pixels`);
      seen.push(now);
    };
    await harness.focusPicture(page);
    await change("the insertion", () => page.keyboard.press("["));
    await change("another insertion", () => page.keyboard.press("["));
    await change("the colours", () => page.keyboard.press("3"));
    await change("a turn", () => drag(page, [600, 400], [520, 360]));
    await change("a move", async () => {
      await page.keyboard.down("Shift");
      await drag(page, [600, 400], [640, 430]);
      await page.keyboard.up("Shift");
    });
    await change("a zoom", async () => {
      await page.mouse.move(600, 400);
      await page.mouse.wheel(0, -300);
    });
    const click = async (name) => {
      const { x, y, width, height } = await harness.control(page, name);
      await page.mouse.click(x + width / 2, y + height / 2);
    };
    await change("what is folded", () => click("Tissue"));
    await change("what it is about", () => click("Inside"));
    const before = { scene: await sceneText(page), stats: await page.evaluate(() => implantPreview.stats()) };
    for (let times = 0; times < 2; times += 1) {
      await lose(page);
      await page.waitForTimeout(1200);
      assert.equal(await page.locator("#lost").isVisible(), true);
      await harness.screenshot(page, "lost");
      // Scripts find the scene meanwhile.
      assert.equal(await sceneText(page), before.scene);
      await restore(page);
      await page.waitForFunction((frames) => implantPreview.stats().frames > frames, before.stats.frames);
      assert.equal(await page.locator("#lost").isVisible(), false);
      const after = await picture(page);
      await harness.screenshot(page, "restored");
      assert.equal(await harness.difference(page, seen.at(-1), after), 0, "the picture is another one");
      assert.equal(await sceneText(page), before.scene);
      const { solves, work_units } = await page.evaluate(() => implantPreview.stats());
      assert.deepEqual([solves, work_units], [before.stats.solves, before.stats.work_units]);
    }
    await page.keyboard.press("Control+z");
    await page.waitForFunction(() => JSON.parse(implantPreview.scene()).insertion === 0.98);
    await page.keyboard.press("Control+z");
    await page.waitForFunction(() => JSON.parse(implantPreview.scene()).insertion === 1);
    assert.equal(await page.locator("#crashed").isVisible(), false);
    await finish();
  });

  test("that does not come back keeps the scene for a reload", async () => {
    const { page, close } = await openApp({ viewport: { width: 390, height: 844 }, options: { colorScheme: "dark" } });
    await harness.focusPicture(page);
    await page.keyboard.press("[");
    await page.waitForFunction(() => JSON.parse(implantPreview.scene()).insertion === 0.98);
    const scene = await sceneText(page);
    await lose(page);
    await page.locator("#lost").waitFor({ state: "visible" });
    await harness.screenshot(page, "lost-phone");
    await Promise.all([page.waitForEvent("load"), page.getByRole("button", { name: "Reload" }).click()]);
    await page.waitForFunction(() => globalThis.implantPreview?.stats().converged);
    assert.equal(await sceneText(page), scene);
    await close();
  });
});

describe("a hidden tab", { timeout: 6 * harness.PATIENCE }, () => {
  // Counts what the page asks the browser to call later.
  const init = `
    globalThis.asked = 0;
    for (const name of ["setTimeout", "setInterval", "requestAnimationFrame", "requestIdleCallback"]) {
      const original = globalThis[name];
      globalThis[name] = (...all) => { asked += 1; return original(...all); };
    }`;
  const state = (tab) =>
    tab.evaluate(`(() => {
      const { frames, work_units, solves } = implantPreview.stats();
      return { visibility: document.visibilityState, frames, work_units, solves, asked };
    })()`);

  test("draws, solves and asks for nothing; play goes on from where it was", async () => {
    const tab = await harness.openTab(fixture.browser, { init });
    await tab.open(fixture.site.address);
    await tab.waitFor("globalThis.implantPreview?.stats().converged");
    await tab.evaluate("implantPreview.focus('3-D view')");
    await tab.waitFor("implantPreview.focused()?.name === '3-D view'");
    const { frames } = await state(tab);
    await tab.press(" ", " ");
    await tab.waitFor(`implantPreview.stats().frames > ${frames + 3}`);

    const other = await harness.openTab(fixture.browser);
    await tab.waitFor("document.hidden");
    await harness.pause(300);
    const before = await state(tab);
    assert.equal(before.visibility, "hidden");
    await harness.pause(4000);
    const after = await state(tab);
    assert.deepEqual(after, before);
    // A script is answered meanwhile; what it asks for waits.
    await tab.evaluate("implantPreview.setScene(implantPreview.scene())");
    await harness.pause(1500);
    assert.deepEqual(await state(tab), before);

    // The first step after the pause is an ordinary one, of at most 0.2 s of the two seconds, however long the pause was: many follow.
    await tab.show();
    await tab.waitFor(`implantPreview.stats().frames > ${before.frames + 6}`);
    assert.equal((await state(tab)).visibility, "visible");
    await other.close();
    await tab.close();
  });

  test("that was opened behind another one starts when it is shown", async () => {
    const tab = await harness.openTab(fixture.browser, { init });
    const other = await harness.openTab(fixture.browser);
    await tab.open(fixture.site.address);
    await tab.waitFor("globalThis.implantPreview");
    await harness.pause(2000);
    const before = await state(tab);
    assert.deepEqual([before.visibility, before.frames, before.work_units], ["hidden", 0, 0]);
    await harness.pause(2000);
    assert.deepEqual(await state(tab), before);
    await tab.show();
    await tab.waitFor("implantPreview.stats().converged && !document.getElementById('loading')");
    assert.equal(await tab.evaluate("document.getElementById('implant-preview-canvas').width > 300"), true);
    await other.close();
    await tab.close();
  });
});

describe("a crash", { timeout: 10 * harness.PATIENCE }, () => {
  // Rust's panic: the window's clock, which must be there, is not.
  const panic = () => {
    Object.defineProperty(window, "performance", { configurable: true, get: () => undefined });
  };
  // An exception of the browser in the middle of a frame, of which Rust hears nothing.
  const throwInside = () => {
    performance.now = () => {
      throw new Error("no clock today");
    };
  };
  // All memory that WebAssembly can have is taken; then a scene asks for more.
  const exhaustMemory = async () => {
    const { memory } = await implantPreviewApi.default();
    for (let pages = 4096; pages >= 1; ) {
      try {
        memory.grow(pages);
      } catch {
        pages /= 2;
      }
    }
    const scene = JSON.parse(implantPreview.scene());
    scene.solver.nodes_per_side = 1025;
    setTimeout(() => implantPreview.setScene(JSON.stringify(scene)));
  };
  const crash = async (page, how) => {
    await page.evaluate(how);
    // Something must happen, for at rest nothing is drawn.
    await page.mouse.move(600, 300);
    await page.locator("#crashed").waitFor({ state: "visible" });
  };
  const reload = async (page) => {
    await Promise.all([page.waitForEvent("load"), page.getByRole("button", { name: "Reload" }).click()]);
    await page.waitForFunction(() => globalThis.implantPreview?.stats().converged);
    await page.locator("#loading").waitFor({ state: "detached" });
    assert.equal(await page.locator("#crashed").isVisible(), false);
  };
  /** The opened app with a scene of its own. */
  const openChanged = async (options) => {
    const opened = await openApp(options);
    await opened.page.evaluate(() => {
      const scene = JSON.parse(implantPreview.scene());
      scene.insertion = 0.8765;
      scene.implant.center_mm = [3, -2];
      implantPreview.setScene(JSON.stringify(scene));
    });
    await opened.page.waitForFunction(() => implantPreview.stats().converged);
    await harness.settled(opened.page);
    return { ...opened, scene: await sceneText(opened.page) };
  };
  const isOpeningScene = async (page) => {
    const opening = await page.evaluate(() => implantPreviewApi.opening_scene());
    assert.deepEqual(JSON.parse(await sceneText(page)), JSON.parse(opening));
  };
  const saveScene = (page) =>
    harness.download(page, () => page.getByRole("button", { name: "Save the scene" }).click());
  const reloadMessage = (page) => page.locator("#crashed-scene").textContent();
  const cause = (page) => page.locator("#crashed-text").textContent();
  const keptScene = (page) => page.evaluate(() => sessionStorage.getItem("implant-preview/kept-scene/1"));

  test("by an exception in a frame, or for want of memory, is shown and keeps the scene; errors of others are none", async () => {
    const { page, scene, close } = await openChanged({
      viewport: { width: 390, height: 844 },
      options: { colorScheme: "dark" },
    });
    // An error of another script, and a scene that is refused.
    await page.evaluate(async () => {
      setTimeout(() => {
        throw new Error("not the program's");
      });
      setTimeout(() => implantPreview.setScene("{"));
      setTimeout(() => implantPreviewApi.simulate("{"));
      Promise.reject(new Error("nor this one"));
      await new Promise((resolve) => setTimeout(resolve, 500));
    });
    assert.equal(await page.locator("#crashed").isVisible(), false);
    assert.equal(await sceneText(page), scene);

    await crash(page, throwInside);
    assert.match(await cause(page), /no clock today/);
    // One that follows from it does not hide its message.
    await page.evaluate(() => implantPreviewCrashed("what followed from it"));
    assert.match(await cause(page), /no clock today/);
    await page.locator("summary").click();
    await harness.screenshot(page, "crashed-phone");
    await reload(page);
    assert.equal(await sceneText(page), scene);
    await harness.screenshot(page, "recovered-phone");

    // Another scene: the same one would be the cause.
    await page.evaluate(() => implantPreview.setPlan("in_place_percent", "80"));
    await page.waitForFunction(() => implantPreview.stats().converged);
    const before = await sceneText(page);
    await crash(page, exhaustMemory);
    assert.match(await reloadMessage(page), /opens this scene again/);
    console.log("out of memory:", await cause(page));
    await reload(page);
    assert.equal(await sceneText(page), before);
    await close();
  });

  test("by a panic keeps the scene for one reload; again with the same scene, or at the start, it leads to the default one", async () => {
    const { page, scene, close } = await openChanged();
    assert.equal(await keptScene(page), null, "kept before there was a crash");
    await crash(page, panic);
    assert.match(await cause(page), /^should have a Performance \(eframe-[\d.]+\/src\/web\/\w+\.rs:\d+\)$/);
    assert.match(await reloadMessage(page), /opens this scene again/);
    await harness.screenshot(page, "crashed");
    assert.equal((await saveScene(page)).text, scene);
    await reload(page);
    assert.equal(await sceneText(page), scene);
    await harness.screenshot(page, "recovered");
    assert.equal(await keptScene(page), null);

    // Again with the same scene.
    await crash(page, panic);
    assert.match(await reloadMessage(page), /twice.*default scene/);
    await harness.screenshot(page, "crashed-twice");
    assert.deepEqual(await saveScene(page), { name: "scene.json", text: scene });
    await reload(page);
    await isOpeningScene(page);

    // At the start, before the first frame: the first thing that the next start does with the scene ends it.
    await page.evaluate((scene) => implantPreview.setScene(scene), scene);
    await page.waitForFunction(() => implantPreview.stats().converged);
    await crash(page, panic);
    await page.addInitScript(() => {
      if (localStorage.getItem("fragile")) {
        const original = HTMLCanvasElement.prototype.getContext;
        HTMLCanvasElement.prototype.getContext = function getContext(...all) {
          if (this.id === "implant-preview-canvas") throw new Error("no context today");
          return original.apply(this, all);
        };
      }
    });
    await page.evaluate(() => localStorage.setItem("fragile", "yes"));
    await page.getByRole("button", { name: "Reload" }).click();
    await page.locator("#crashed-scene").getByText("twice").waitFor();
    assert.match(await cause(page), /context/);
    assert.equal((await saveScene(page)).text, scene);
    await page.evaluate(() => localStorage.clear());
    await reload(page);
    await isOpeningScene(page);

    // A broken kept scene is not opened.
    await page.evaluate(() => sessionStorage.setItem("implant-preview/kept-scene/1", '{"schema":"of another time"}'));
    await page.reload();
    await page.waitForFunction(() => globalThis.implantPreview?.stats().converged);
    await isOpeningScene(page);
    await close();
  });

  test("without storage says that the scene must be saved first", async () => {
    for (const init of [
      () => {
        Object.defineProperty(window, "sessionStorage", {
          get() {
            throw new DOMException("denied", "SecurityError");
          },
        });
      },
      () => {
        Storage.prototype.setItem = () => {
          throw new DOMException("full", "QuotaExceededError");
        };
      },
    ]) {
      const { page, scene, close } = await openChanged({ init });
      await crash(page, panic);
      assert.match(await reloadMessage(page), /cannot keep the scene.*save the scene first/);
      assert.equal((await saveScene(page)).text, scene);
      await reload(page);
      await close();
    }
  });
});
