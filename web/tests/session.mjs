// Plays the page in headless Chromium with real mouse and keyboard events, and checks by the viewer's own state that each took effect.
// Then slows the physics and measures that the page does not mind, and tries what browsers, servers and people do to a page (page.mjs).
//
// node web/tests/session.mjs [FOLDER FOR PICTURES]     after `cargo xtask web` and `npm ci --prefix web`

import { mkdirSync } from "node:fs";
import { join } from "node:path";
import { check, chord, key, launch, open, pictures, playing, serve, state, until, web } from "./browser.mjs";
import { behaviour } from "./page.mjs";

const out = process.argv[2] ?? join(web, "out");
mkdirSync(out, { recursive: true });

/** What panels may cover at the left, top, right and bottom. Pixels. */
const MARGINS = [240, 60, 300, 220];

/** How long pictures are timed. Seconds. */
const STALL_S = 10;

async function press(page, [x, y]) {
  await page.mouse.move(x, y);
  await pictures(page, 1);
  await page.mouse.down();
  return pictures(page);
}

async function dragOn(page, from, to, steps = 6) {
  for (let i = 1; i <= steps; i++) {
    await page.mouse.move(from[0] + ((to[0] - from[0]) * i) / steps, from[1] + ((to[1] - from[1]) * i) / steps);
    await pictures(page, 1);
  }
}

async function release(page) {
  await page.mouse.up();
  return pictures(page);
}

/** A body that can be clicked at and that no panel covers. */
async function body(page) {
  const { width, height } = page.viewportSize();
  const [left, top, right, bottom] = MARGINS;
  const s = await state(page);
  const clear = ({ pixel: [x, y] }) => left < x && x < width - right && top < y && y < height - bottom;
  const found = s.play.in_sight.find(clear);
  if (!found) {
    throw new Error(`no body is in sight: ${JSON.stringify(s.play.in_sight)}`);
  }
  return found;
}

/** Start, pause, scrub, throw, drag, undo. */
async function session(page) {
  const begin = (await state(page)).play.time_s;
  await until(page, "start: time goes on", (s) => s.play.time_s > begin + 0.2);
  const paused = await key(page, "Space");
  const later = await pictures(page, 4);
  const still = later.play.time_s === paused.play.time_s && later.play.samples_hash === paused.play.samples_hash;
  check(paused.play.paused && still, "pause: time and all bodies stand still");
  await scrub(page);
  await throwOne(page);
  await drag(page);
  await undo(page);
}

/** Drags the playhead in the timeline strip, into the future and into the past. */
async function scrub(page) {
  await until(page, "physics is ahead", (s) => s.play.horizon_s > s.play.time_s + 1);
  const { play } = await state(page);
  for (const [what, to_s] of [["the future", play.time_s + 0.8], ["the past", 0.5 * play.time_s]]) {
    const now = await state(page);
    const { x, y, width, height, from_s, to_s: end_s } = now.strip;
    const pixel = (time_s) => [x + ((time_s - from_s) / (end_s - from_s)) * width, y + 0.5 * height];
    await press(page, pixel(now.play.time_s));
    await dragOn(page, pixel(now.play.time_s), pixel(to_s));
    await release(page);
    const slack = (3 * (end_s - from_s)) / width + 0.02;
    // Software that draws under load is some pictures behind the mouse.
    const near = (s) => Math.abs(s.play.time_s - to_s) <= slack;
    const then = await until(page, "", near, 20);
    // What rests by then is where it was, to the bit.
    const resting = play.in_sight.every(({ speed }) => speed === 0);
    check(resting || then.play.samples_hash !== play.samples_hash, `scrub: the playhead is dragged into ${what}`);
  }
}

/** Throws a body, after a preview that the worker computed. */
async function throwOne(page) {
  await key(page, "t");
  const before = (await state(page)).play;
  await press(page, (await body(page)).pixel);
  const aimed = await until(page, "throw: a preview is there while it is aimed", ({ play }) => play.aiming && play.preview);
  await release(page);
  const { play } = await until(page, "throw: the body is there", (s) => s.play.bodies === before.bodies + 1);
  check(play.thrown === aimed.play.preview.body, "throw: it is the one that was previewed");
  check(play.undo === before.undo + 1 && play.undo_label === "throw", "throw: it can be taken back");
}

/** Drags a body by its spring while time runs, and sees it lifted. */
async function drag(page) {
  await key(page, "q");
  await key(page, "Space");
  const { pixel, position } = await body(page);
  await press(page, pixel);
  await dragOn(page, pixel, [pixel[0] + 70, pixel[1] - 90], 8);
  await until(page, "drag: the body under the mouse is dragged", ({ play }) => play.dragged !== null && play.selected[0] === play.dragged);
  await until(page, "drag: it is lifted", ({ play }) => play.selected_position[1] > position[1] + 0.1);
  await release(page);
  await key(page, "Space");
  const { play } = await until(page, "drag: paused again", (s) => s.play.paused && s.play.dragged === null);
  check(play.undo_label === "drag", "drag: it is one step to take back");
}

async function undo(page) {
  const before = (await state(page)).play;
  await chord(page, "Control", "z");
  await until(page, "undo: the drag is taken back", ({ play }) => play.undo === before.undo - 1 && play.redo === 1);
  await chord(page, "Control", "z");
  await until(page, "undo: the thrown body is gone", ({ play }) => play.bodies === before.bodies - 1);
  await chord(page, "Control", "y");
  await until(page, "redo: it is back", ({ play }) => play.bodies === before.bodies);
}

/** Longest and middle interval between pictures of the page, over some seconds. Milliseconds. */
const intervals = (page, seconds) =>
  page.evaluate(
    (ms) =>
      new Promise((done) => {
        const found = [];
        let last = performance.now();
        const end = last + ms;
        const tick = () => {
          const now = performance.now();
          found.push(now - last);
          last = now;
          if (now < end) {
            requestAnimationFrame(tick);
          } else {
            found.sort((a, b) => a - b);
            done({ count: found.length, middle: found[found.length >> 1], longest: found[found.length - 1] });
          }
        };
        requestAnimationFrame(tick);
      }),
    seconds * 1000,
  );

/** Physics takes 0.2 to 1 s a frame; the page's pictures come on as without. */
async function stall(browser, server) {
  const view = { width: 1280, height: 720 };
  const measured = async (query) => {
    const page = await open(browser, server, query, { viewport: view });
    const before = (await state(page)).play.horizon_s;
    const found = await intervals(page, STALL_S);
    found.computed_s = (await state(page)).play.horizon_s - before;
    await page.close();
    console.log(`  ${query}: ${found.count} pictures, middle ${found.middle.toFixed(1)} ms, longest ${found.longest.toFixed(1)} ms`);
    return found;
  };
  const normal = await measured("?scene=dominoes:30");
  const stalled = await measured("?scene=dominoes:30&slow=200-1000");
  check(stalled.computed_s < 0.1 * STALL_S, `physics is slow: ${stalled.computed_s.toFixed(2)} s computed in ${STALL_S} s`);
  check(stalled.longest < 2 * Math.max(normal.longest, 1000 / 60), "no picture waits for physics");
}

const server = await serve();
const browser = await launch();
let failed;
try {
  const view = { width: 1280, height: 720 };
  await stall(browser, server);
  const page = await open(browser, server, "?scene=pyramid:5", { viewport: view });
  await session(page);
  await page.close();
  await behaviour(browser, server);
  for (const scene of ["dominoes:30", "pyramid:8", "tori:6"]) {
    const page = await open(browser, server, `?scene=${scene}`, { viewport: view, draws: true });
    await until(page, "the moment has come", (s) => s.play.time_s > 1);
    await page.screenshot({ path: join(out, `web-${scene.split(":")[0]}.png`) });
    await page.close();
  }
} catch (error) {
  failed = error;
} finally {
  await browser.close();
  server.close();
}
if (failed) {
  console.error(`${failed.message}`);
  process.exitCode = 1;
} else {
  console.log("all as it should be");
}
