// Plays the page in headless Chromium with real mouse and keyboard events, and checks by the viewer's own state that each took effect.
// Then slows the physics and measures that the page does not mind.
//
// node web/tests/session.mjs [FOLDER FOR PICTURES]     after `cargo xtask web` and `npm ci --prefix web`

import { mkdirSync, readFileSync } from "node:fs";
import { createServer } from "node:http";
import { extname, join, normalize } from "node:path";
import { fileURLToPath } from "node:url";
import { chromium } from "playwright-core";

const web = fileURLToPath(new URL("..", import.meta.url));
const dist = join(web, "dist");
const out = process.argv[2] ?? join(web, "out");
mkdirSync(out, { recursive: true });

const FLAGS = [
  "--no-sandbox", "--disable-quic", "--no-first-run", "--disable-background-networking", "--disable-component-update",
  "--disable-sync", "--use-gl=angle", "--use-angle=swiftshader", "--enable-unsafe-swiftshader",
];
const TYPES = { ".html": "text/html", ".js": "text/javascript", ".wasm": "application/wasm" };

/** A plain file server, without special headers. */
async function serve() {
  const server = createServer((request, response) => {
    const path = normalize(new URL(request.url, "http://x").pathname);
    try {
      const content = readFileSync(join(dist, path === "/" ? "index.html" : path));
      response.writeHead(200, { "content-type": TYPES[extname(path)] ?? TYPES[".html"] }).end(content);
    } catch {
      response.writeHead(404).end();
    }
  });
  await new Promise((ready) => server.listen(0, "127.0.0.1", ready));
  return server;
}

const state = (page) => page.evaluate(() => window.forerun_state?.() ?? null);

/** Waits until the state is as wanted. */
async function until(page, what, wanted, seconds = 90) {
  let last;
  for (const end = Date.now() + seconds * 1000; Date.now() < end; ) {
    last = await state(page).catch(() => null);
    if (last && wanted(last)) {
      console.log(`  ${what}`);
      return last;
    }
    await page.waitForTimeout(50);
  }
  const notice = await page.evaluate(() => document.getElementById("notice").textContent);
  throw new Error(`${what}: not within ${seconds} s; ${notice} ${JSON.stringify(last)}`);
}

const playing = (s) => s.stage === "playing" && s.play.bodies > 0 && s.play.horizon_s > 0.5;

async function open(browser, server, query, viewport) {
  const page = await browser.newPage({ viewport });
  page.on("pageerror", (error) => {
    if (!`${error}`.includes("isn't actually an error")) {
      console.log(`  page: ${error}`);
    }
  });
  await page.goto(`http://127.0.0.1:${server.address().port}/${query}`);
  await until(page, `${query || "dominoes"} plays`, playing);
  return page;
}

const key = async (page, name) => {
  await page.keyboard.press(name, { delay: 60 });
};

/** Start, pause, step, scrub, pick, throw, drag, undo. */
async function session(page) {
  const { width, height } = page.viewportSize();
  await page.mouse.click(width / 2, height * 0.9);
  await key(page, "Space");
  let s = await until(page, "paused", (s) => s.play.paused);
  await page.waitForTimeout(500);
  const still = await state(page);
  check(still.play.time_s === s.play.time_s, "time stands still");
  await key(page, "ArrowRight");
  await until(page, "a step forward", (now) => now.play.time_s > s.play.time_s);
  await key(page, "Home");
  await until(page, "at the start", (now) => now.play.time_s <= now.play.oldest_s + 1e-6);
  await key(page, "End");
  s = await until(page, "at the horizon", (now) => now.play.time_s > 0.5);
  await key(page, "Home");
  await until(page, "back at the start", (now) => now.play.time_s < s.play.time_s);
  await scrub(page);
  await pick(page);
  await throwOne(page);
  await drag(page);
  await key(page, "Space");
  s = await state(page);
  await until(page, "plays again", (now) => !now.play.paused && now.play.time_s > s.play.time_s);
}

/** Drags the playhead in the timeline strip, where the report says that it is. */
async function scrub(page) {
  const s = await state(page);
  const strip = s.strip ?? s.play.strip;
  if (!strip) {
    throw new Error("the report does not say where the timeline strip is");
  }
  const [left, top, right, bottom] = strip;
  const y = (top + bottom) / 2;
  await page.mouse.move(left + 4, y);
  await page.mouse.down();
  await page.waitForTimeout(200);
  await page.mouse.move(left + 0.5 * (right - left), y, { steps: 4 });
  await until(page, "scrubbed", (now) => Math.abs(now.play.time_s - s.play.time_s) > 0.05);
  await page.mouse.up();
}

/** Clicks across the picture until a body is picked. */
async function pick(page) {
  const { width, height } = page.viewportSize();
  for (const [x, y] of places(width, height)) {
    await page.mouse.click(x, y, { delay: 80 });
    await page.waitForTimeout(300);
    const s = await state(page);
    if (s.play.selected.length === 1 && s.play.selected[0] !== 0) {
      console.log(`  body ${s.play.selected[0]} picked`);
      return [x, y];
    }
  }
  throw new Error("no click picked a body");
}

function* places(width, height) {
  for (const v of [0.5, 0.45, 0.55, 0.4, 0.6]) {
    for (const u of [0.5, 0.4, 0.6, 0.3, 0.7, 0.45, 0.55]) {
      yield [width * u, height * v];
    }
  }
}

/** Throws a body, sees one more, and takes it back. */
async function throwOne(page) {
  const { width, height } = page.viewportSize();
  const { bodies, time_s } = (await state(page)).play;
  await key(page, "t");
  await page.mouse.move(width * 0.5, height * 0.5);
  await page.mouse.down();
  await page.waitForTimeout(300);
  await page.mouse.move(width * 0.5, height * 0.4, { steps: 4 });
  await page.waitForTimeout(300);
  await page.mouse.up();
  await page.waitForTimeout(300);
  await key(page, "ArrowRight");
  await until(page, "a body is thrown", (s) => s.play.bodies === bodies + 1 && s.play.time_s > time_s);
  await key(page, "Control+z");
  await until(page, "the throw is undone", (s) => s.play.bodies === bodies);
  await key(page, "Control+y");
  await until(page, "and done again", (s) => s.play.bodies === bodies + 1);
  await key(page, "q");
}

/** Drags a body by its spring while time runs, and sees it elsewhere. */
async function drag(page) {
  const [x, y] = await pick(page);
  const before = (await state(page)).play;
  await page.mouse.move(x, y);
  await page.mouse.down();
  await page.waitForTimeout(300);
  await key(page, "Space");
  await page.mouse.move(x + 60, y - 60, { steps: 6 });
  const [a, b, c] = before.selected_position;
  await until(page, "a body is dragged", ({ play }) => {
    const [d, e, f] = play.selected_position ?? [a, b, c];
    return Math.hypot(a - d, b - e, c - f) > 0.05;
  });
  await page.mouse.up();
  await key(page, "Space");
  await until(page, "paused again", (s) => s.play.paused);
}

function check(right, what) {
  if (!right) {
    throw new Error(`not so: ${what}`);
  }
  console.log(`  ${what}`);
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

/** Physics takes 0.2 to 1 s a frame; the page's pictures come on as without. Small, as software draws them. */
async function stall(browser, server) {
  const small = { width: 160, height: 120 };
  const free = await open(browser, server, "?scene=dominoes:10", small);
  await key(free, "Space");
  const normal = await intervals(free, 6);
  await free.close();
  const slow = await browser.newPage({ viewport: small });
  await slow.goto(`http://127.0.0.1:${server.address().port}/?scene=dominoes:10&slow=200-1000`);
  await until(slow, "plays with slow physics", (s) => s.stage === "playing");
  const stalled = await intervals(slow, 10);
  const { play } = await state(slow);
  await slow.close();
  const say = (name, i) => console.log(`  ${name}: ${i.count} pictures, middle ${i.middle.toFixed(1)} ms, longest ${i.longest.toFixed(1)} ms`);
  say("physics at ease", normal);
  say("physics stalls  ", stalled);
  check(play.horizon_s < 2, "physics is slow");
  check(stalled.longest < Math.max(2 * normal.middle, 1.5 * normal.longest, 34), "no picture waits for physics");
}

const server = await serve();
const browser = await chromium.launch({ executablePath: process.env.CHROMIUM ?? "/usr/bin/chromium", headless: true, args: FLAGS });
let failed;
try {
  const view = { width: 960, height: 540 };
  const first = await open(browser, server, "?scene=dominoes:30", view);
  await first.screenshot({ path: join(out, "web-dominoes.png") });
  for (const [scene, seconds] of [["pyramid:8", 1], ["tori:6", 1]]) {
    const page = await open(browser, server, `?scene=${scene}`, view);
    await page.waitForTimeout(seconds * 1000);
    await page.screenshot({ path: join(out, `web-${scene.split(":")[0]}.png`) });
    await page.close();
  }
  await stall(browser, server);
  await session(first);
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
