// What tests of the page share: a plain file server, headless Chromium, and the viewer's own state.

import { readFileSync } from "node:fs";
import { createServer } from "node:http";
import { extname, join, normalize } from "node:path";
import { fileURLToPath } from "node:url";
import { chromium } from "playwright-core";

export const web = fileURLToPath(new URL("..", import.meta.url));
export const dist = join(web, "dist");

const FLAGS = [
  "--no-sandbox", "--disable-quic", "--no-first-run", "--disable-background-networking", "--disable-component-update",
  "--disable-sync", "--use-gl=angle", "--use-angle=swiftshader", "--enable-unsafe-swiftshader",
];
const TYPES = { ".html": "text/html", ".js": "text/javascript", ".wasm": "application/wasm", ".svg": "image/svg+xml" };

export const launch = () =>
  chromium.launch({ executablePath: process.env.CHROMIUM ?? "/usr/bin/chromium", headless: true, args: FLAGS });

/** A plain file server, without special headers. It has the page in a folder of its own, and the repository's scenes beside it. */
export async function serve() {
  const server = createServer((request, response) => {
    const path = normalize(new URL(request.url, "http://x").pathname);
    const file = path.startsWith("/scenes/") ? join(web, "..", path) : join(dist, path.replace("/viewer/", "/"));
    try {
      const content = readFileSync(file.endsWith("/") ? join(file, "index.html") : file);
      response.writeHead(200, { "content-type": TYPES[extname(file)] ?? TYPES[".html"] }).end(content);
    } catch {
      response.writeHead(404).end();
    }
  });
  await new Promise((ready) => server.listen(0, "127.0.0.1", ready));
  return server;
}

export const address = (server, query) => `http://127.0.0.1:${server.address().port}/viewer/${query}`;

export const state = (page) => page.evaluate(() => window.forerun_state?.() ?? null);

/** What the page itself says. */
export const notice = (page) => page.evaluate(() => document.getElementById("notice").textContent);

/** Waits until the state is as wanted. */
export async function until(page, what, wanted, seconds = 90) {
  let last;
  for (const end = Date.now() + seconds * 1000; Date.now() < end; ) {
    last = await state(page).catch(() => null);
    if (last && wanted(last)) {
      if (what) {
        console.log(`  ${what}`);
      }
      return last;
    }
    await page.waitForTimeout(50);
  }
  throw new Error(`${what}: not within ${seconds} s; ${await notice(page)} ${JSON.stringify(last)}`);
}

export function check(right, what) {
  if (!right) {
    throw new Error(`not so: ${what}`);
  }
  console.log(`  ${what}`);
}

export const playing = (s) => s.stage === "playing" && s.play.bodies > 0 && s.play.horizon_s > 0;

/** Draws nothing: software that draws takes a second a picture, and is not what is looked at. */
const drawNothing = () => {
  for (const name of ["drawArrays", "drawArraysInstanced", "drawElements", "drawElementsInstanced", "clear", "blitFramebuffer", "readPixels"]) {
    WebGL2RenderingContext.prototype[name] = () => {};
  }
};

/** A page that is on its way to the viewer; `options` are those of a browser's context, and whether it draws. */
export async function begin(browser, server, query, { draws = false, before, ...options } = {}) {
  const page = await browser.newPage(options);
  if (!draws) {
    await page.addInitScript(drawNothing);
  }
  if (before) {
    await before(page);
  }
  page.on("pageerror", (error) => {
    if (!`${error}`.includes("isn't actually an error")) {
      console.log(`  page: ${error}`);
    }
  });
  await page.goto(address(server, query));
  return page;
}

/** A page with a viewer that plays. */
export async function open(browser, server, query, options) {
  const page = await begin(browser, server, query, options);
  await until(page, `${query || "dominoes"} plays`, playing);
  return page;
}

/** Waits until some pictures more are drawn: what was pressed before has been seen then. */
export async function pictures(page, count = 2) {
  const { pictures } = await state(page);
  return until(page, "", (s) => s.pictures >= pictures + count);
}

export async function key(page, name) {
  await page.keyboard.down(name);
  await pictures(page, 1);
  await page.keyboard.up(name);
  return pictures(page);
}

export async function chord(page, modifier, name) {
  await page.keyboard.down(modifier);
  await pictures(page, 1);
  await key(page, name);
  await page.keyboard.up(modifier);
  return pictures(page);
}
