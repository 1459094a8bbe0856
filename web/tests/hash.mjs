// Whether physics in WebAssembly comes to the same bits as natively: the hash of all states of some scenes after 600 frames.
//
// node web/tests/hash.mjs [FORERUN [SCENE...]]     after `cargo build --release` and `cargo xtask web`

import { execFileSync } from "node:child_process";
import { readFileSync } from "node:fs";

const FRAMES = 600;
const SCENES = ["dominoes:50", "pyramid:8", "tori:6", "mugs:4", "rain:60"];

const root = new URL("../../", import.meta.url);
const [program = new URL("target/release/forerun", root).pathname, ...named] = process.argv.slice(2);
const dist = new URL("web/dist/", root);
const { initSync, state_hash } = await import(new URL("forerun_web.js", dist));
initSync({ module: readFileSync(new URL("forerun_web_bg.wasm", dist)) });

let same = true;
for (const scene of named.length > 0 ? named : SCENES) {
  const output = execFileSync(program, ["bench", scene, "--frames", `${FRAMES}`, "--json"], { encoding: "utf8" });
  const native = /"state_hash":\s*"([0-9a-f]{16})"/.exec(output)?.[1];
  const wasm = state_hash(scene, FRAMES);
  const agrees = native === wasm;
  same &&= agrees;
  console.log(`${scene.padEnd(14)} native ${native}  wasm ${wasm}  ${agrees ? "same" : "DIFFERENT"}`);
}
process.exitCode = same ? 0 : 1;
