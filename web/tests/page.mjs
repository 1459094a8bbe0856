// What browsers, servers and people do to a page, and what it is to make of it: checked by the viewer's state and by what the page says.

import { readFileSync } from "node:fs";
import { join } from "node:path";
import { address, begin, check, dist, key, notice, open, pictures, playing, state, until, web } from "./browser.mjs";

const VIEW = { width: 1280, height: 720 };

/** All of it. */
export async function behaviour(browser, server) {
  await scenes(browser, server);
  await addresses(browser, server);
  await driver(browser, server);
  await keys(browser, server);
  await habits(browser, server);
  await touch(browser, server);
  await broken(browser, server);
  await faults(browser, server);
}

const drop = (page, name, text) =>
  page.evaluate(
    ([name, text]) => {
      const dataTransfer = new DataTransfer();
      dataTransfer.items.add(new File([text], name));
      window.dispatchEvent(new DragEvent("drop", { dataTransfer, bubbles: true, cancelable: true }));
    },
    [name, text],
  );

/** Waits until the page says something. */
async function says(page, what, wanted) {
  await page.waitForFunction((wanted) => new RegExp(wanted).test(document.getElementById("notice").textContent), wanted.source, { timeout: 20000 });
  console.log(`  ${what}`);
}

/** Scenes that are dropped, one after the other. */
async function scenes(browser, server) {
  const page = await open(browser, server, "?scene=pyramid:3", { viewport: VIEW });
  const text = readFileSync(join(web, "../scenes/stack.toml"), "utf8");
  for (let opened = 2; opened < 5; opened++) {
    await drop(page, "stack.toml", text);
    await until(page, "", (s) => s.opened === opened && playing(s));
  }
  check((await state(page)).scene === "stack.toml", "drop: a scene file opens");
  check(page.workers().length === 1, "drop: the workers of the scenes before have ended");
  await drop(page, "broken.toml", "[[bodies]]\nshape = {");
  await pictures(page, 4);
  const { opened, stage } = await state(page);
  check(opened === 4 && stage === "playing", "drop: a broken file changes nothing");
  await drop(page, "bunny.obj", "v 0 0 0");
  await says(page, "drop: what is no scene is said to be none", /bunny\.obj is no scene/);
  await page.close();
}

/** Scenes that the address names. */
async function addresses(browser, server) {
  const page = await open(browser, server, "?scene=../scenes/stack.toml", { viewport: VIEW });
  check((await state(page)).scene === "stack.toml", "address: a scene file of the server opens");
  await page.goto(address(server, "?scene=nowhere.toml"));
  await says(page, "address: a file that is not there is said not to be", /nowhere\.toml could not be fetched: the server says 404/);
  await until(page, "", playing);
  await page.goto(address(server, "?scene=nosuch"));
  const failed = await until(page, "address: a name that is none fails", (s) => s.stage === "failed");
  check(failed.failure.includes("there is no built-in scene"), "address: and says why");
  await drop(page, "mesh.toml", readFileSync(join(web, "../scenes/stack.toml"), "utf8") + '\n[meshes.bunny]\nfile = "bunny.obj"\n');
  const { failure } = await until(page, "", (s) => s.opened === 2 && s.stage === "failed");
  check(failure.includes("bunny.obj"), "a mesh in a file beside the scene: said which, and that a page cannot read it");
  await page.close();
}

/** The traditional driver on the page, and back. */
async function driver(browser, server) {
  const page = await open(browser, server, "?scene=pyramid:5", { viewport: VIEW });
  await key(page, "x");
  await key(page, "k");
  const { play } = await until(page, "coupled: by one key", (s) => s.play.coupled);
  await until(page, "coupled: time goes on", (s) => s.play.time_s > play.time_s + 0.2);
  await key(page, "k");
  await until(page, "decoupled again: physics is ahead", (s) => !s.play.coupled && s.play.horizon_s > s.play.time_s + 0.5);
  check(page.workers().length === 1, "decoupled again: by one new worker");
  await page.close();
}

/** Keys that a browser and a viewer both want. */
async function keys(browser, server) {
  const page = await open(browser, server, "?scene=pyramid:3", { viewport: VIEW });
  await page.evaluate(() => {
    window.taken = {};
    const note = (event) => setTimeout(() => (window.taken[event.key] = event.defaultPrevented));
    window.addEventListener("keydown", note, { capture: true });
  });
  for (const name of ["F5", "F11", "Control+f", "Alt+ArrowLeft", "F1", "Control+z", "End"]) {
    await page.keyboard.press(name);
  }
  const { F5, F11, f, ArrowLeft, F1, z, End } = await page.evaluate(() => new Promise((done) => setTimeout(() => done(window.taken), 50)));
  check(!F5 && !F11 && !f && !ArrowLeft, "keys: the browser keeps its own");
  check(F1 && z && End, "keys: the viewer has those that it lists");
  // As when another window is chosen while a key is held: it goes up unheard.
  await page.keyboard.down("Control");
  await page.evaluate(() => {
    window.addEventListener("keyup", (event) => event.isTrusted && event.stopImmediatePropagation(), { capture: true, once: true });
    window.dispatchEvent(new Event("blur"));
  });
  await page.keyboard.up("Control");
  const { shown } = (await state(page)).view.ghosts;
  await key(page, "g");
  check((await state(page)).view.ghosts.shown !== shown, "keys: Ctrl is let go when the window loses the focus");
  await page.close();
}

/** Settings, the system's theme, a screenshot, the size of the page. */
async function habits(browser, server) {
  const page = await open(browser, server, "?scene=pyramid:3", { viewport: VIEW, colorScheme: "light", deviceScaleFactor: 2 });
  const first = await state(page);
  check(first.view.theme === "light", "theme: the system's at first");
  check(first.window[0] === 2560 && first.pixels_per_point === 2, "two pixels a point: all of them are drawn");
  await page.setViewportSize({ width: 900, height: 700 });
  await until(page, "another size: the picture is as large", (s) => s.window[0] === 1800 && s.window[1] === 1400);
  await key(page, "F10");
  await page.reload();
  await until(page, "", playing);
  check((await state(page)).view.theme === "dark", "settings: kept when the page is left at once");
  await page.evaluate(() => localStorage.setItem("forerun-viewer", "{"));
  await page.addInitScript(() => localStorage.setItem("forerun-viewer", "{"));
  await page.reload();
  await until(page, "settings: broken ones do no harm", playing);
  const saved = page.waitForEvent("download");
  await key(page, "F12");
  check((await saved).suggestedFilename().endsWith(".png"), "screenshot: a download");
  await page.close();
}

/** Fingers on a phone. */
async function touch(browser, server) {
  const options = { viewport: { width: 390, height: 844 }, deviceScaleFactor: 2, hasTouch: true, isMobile: true };
  const page = await open(browser, server, "?scene=pyramid:5", options);
  await key(page, "Space");
  const session = await page.context().newCDPSession(page);
  const fingers = async (type, ...points) => {
    await session.send("Input.dispatchTouchEvent", { type, touchPoints: points.map(([x, y], id) => ({ x, y, id })) });
    await pictures(page, 1);
  };
  const places = async () => new Map((await state(page)).play.in_sight.map(({ id, pixel }) => [id, pixel.map((p) => p / 2)]));
  const { view } = await state(page);
  check(!view.open.tools && !view.open.inspector, "phone: the picture has the screen");
  const [[id, place]] = await places();
  await fingers("touchStart", place);
  await fingers("touchEnd");
  await until(page, "phone: a tap picks", (s) => s.play.selected[0] === id);
  const before = await places();
  await fingers("touchStart", [60, 150]);
  for (let i = 1; i <= 4; i++) {
    await fingers("touchMove", [60 + 30 * i, 150]);
  }
  await fingers("touchEnd");
  const turned = await places();
  const by = (id) => Math.hypot(before.get(id)[0] - turned.get(id)[0], before.get(id)[1] - turned.get(id)[1]);
  check([...before.keys()].some((id) => turned.has(id) && by(id) > 2), "phone: one finger goes round");
  // Of those that are still in sight.
  const width = (places, others) => {
    const across = [...places].filter(([id]) => others.has(id)).map(([, [x]]) => x);
    return Math.max(...across) - Math.min(...across);
  };
  await fingers("touchStart", [150, 150]);
  await fingers("touchStart", [150, 150], [240, 150]);
  for (let i = 1; i <= 4; i++) {
    await fingers("touchMove", [150 - 5 * i, 150], [240 + 5 * i, 150]);
  }
  await fingers("touchEnd");
  const near = await places();
  check(width(near, turned) > 1.25 * width(turned, near), "phone: two fingers that part come nearer");
  await fingers("touchStart", [150, 150]);
  await fingers("touchStart", [150, 150], [240, 150]);
  for (let i = 1; i <= 4; i++) {
    await fingers("touchMove", [150, 150 + 15 * i], [240, 150 + 15 * i]);
  }
  await fingers("touchEnd");
  const panned = await places();
  const down = [...near.keys()].filter((id) => panned.has(id)).map((id) => panned.get(id)[1] - near.get(id)[1]);
  check(down.length > 0 && down.every((pixels) => pixels > 20), "phone: two fingers move the picture");
  const { play } = await state(page);
  await key(page, "t");
  await fingers("touchStart", place);
  await fingers("touchStart", place, [240, 150]);
  await pictures(page, 3);
  await fingers("touchEnd");
  await pictures(page, 3);
  check((await state(page)).play.bodies === play.bodies, "phone: a second finger leaves off a throw");
  await page.close();
}

/** What cannot work says so. */
async function broken(browser, server) {
  const answer = (glob, response) => (page) => page.route(glob, (route) => route.fulfill(response));
  const script = readFileSync(join(dist, "main.js"), "utf8");
  const cases = [
    ["no WebGL 2", (page) => page.addInitScript(() => (HTMLCanvasElement.prototype.getContext = () => null)), /without WebGL 2/],
    ["no SIMD", (page) => page.addInitScript(() => (WebAssembly.validate = () => false)), /too old/],
    ["no module", answer("**/*.wasm", { status: 404 }), /cannot start.*404/],
    ["a damaged module", answer("**/*.wasm", { body: "damaged", contentType: "application/wasm" }), /cannot start.*magic word/],
    ["no glue", answer("**/forerun_web.js", { status: 404 }), /could not be loaded/],
    ["scripts that are served as text", answer("**/main.js", { body: script, contentType: "text/plain" }), /could not be loaded.*text\/javascript/],
  ];
  for (const [what, before, wanted] of cases) {
    const page = await begin(browser, server, "", { viewport: VIEW, before });
    await says(page, `${what}: the page says so`, wanted);
    await page.close();
  }
  const page = await browser.newPage();
  await page.goto(`file://${join(dist, "index.html")}`);
  await says(page, "opened from a file: the page says what to do", /http\.server/);
  await page.close();
  const wasm = readFileSync(join(dist, "forerun_web_bg.wasm"));
  const plain = answer("**/*.wasm", { body: wasm, contentType: "text/plain" });
  await (await open(browser, server, "?scene=pyramid:2", { viewport: VIEW, before: plain })).close();
  console.log("  a module that is served as text: plays");
}

/** What breaks while it plays. */
async function faults(browser, server) {
  const none = (page) => page.route("**/worker.js", (route) => route.fulfill({ status: 404 }));
  const unplayed = await begin(browser, server, "?scene=pyramid:2", { viewport: VIEW, before: none });
  const { failure } = await until(unplayed, "no worker: the viewer is there", (s) => s.stage === "failed");
  check(failure.includes("worker.js"), "no worker: it says what is missing");
  await unplayed.close();
  const page = await open(browser, server, "?scene=pyramid:3", { viewport: VIEW });
  await page.workers()[0].evaluate(() => void setTimeout(() => { throw new Error("a fault"); }));
  const failed = await until(page, "a worker that breaks: the viewer is there", (s) => s.stage === "failed");
  check(failed.failure.includes("a fault"), "a worker that breaks: it says why");
  check((await notice(page)) === "", "a worker that breaks: and says it once");
  await page.keyboard.down("Control");
  await key(page, "r");
  await page.keyboard.up("Control");
  await until(page, "a worker that breaks: the scene can be read again", playing);
  await page.evaluate(() => document.querySelector("canvas").getContext("webgl2").getExtension("WEBGL_lose_context").loseContext());
  await says(page, "graphics that are taken away: the page says so", /Reload the page/);
  await page.close();
}
