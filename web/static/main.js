// Starts the viewer in the page's canvas. Everything else is in the WebAssembly module and in worker.js.

import init, * as forerun from "./forerun_web.js";
import { gestures } from "./touch.js";

/** The smallest module with a lane of SIMD in it. */
const SIMD = [0, 97, 115, 109, 1, 0, 0, 0, 1, 5, 1, 96, 0, 1, 123, 3, 2, 1, 0, 10, 10, 1, 8, 0, 65, 0, 253, 15, 253, 98, 11];

/** How names of scene files end. */
const SCENE_FILE = /\.(toml|json)$/i;

/** Keys that mean something to the viewer together with Ctrl, and with Ctrl and Shift; others are the browser's. */
const WITH_CTRL = ["a", "d", "o", "r", "y", "z", "=", "+", "-", "f12"];
const WITH_CTRL_SHIFT = ["z", "+"];
/** Keys that mean nothing to the viewer. */
const OF_BROWSER = /^(F[2-9]|F11)$/;
/** Keys that others are held together with, and where they are. */
const MODIFIERS = { Control: "ControlLeft", Shift: "ShiftLeft", Alt: "AltLeft" };
const IS_MAC = /Mac|iP/.test(navigator.platform);

const wishes = new URLSearchParams(location.search);
const canvas = document.querySelector("canvas");

/** Why the viewer cannot run here. */
function lacking() {
  if (!window.WebAssembly?.validate(new Uint8Array(SIMD)) || !window.Worker) {
    return "This browser is too old for the viewer, which needs WebAssembly with SIMD, and workers: Chrome and Edge 91, Firefox 114 and Safari 16.4 have them.";
  }
  if (!document.createElement("canvas").getContext("webgl2")) {
    return "This browser draws without WebGL 2, which the viewer needs. Where it is up to date, turn on hardware acceleration in its settings.";
  }
  return undefined;
}

/** The scene that the address asks for: a name and, where it is a file, its text. */
async function wished(scene) {
  if (!SCENE_FILE.test(scene)) {
    return { scene };
  }
  const answer = await fetch(scene);
  if (!answer.ok) {
    throw new Error(`the server says ${answer.status}`);
  }
  return { scene: scene.split("/").pop(), text: await answer.text() };
}

/** From `?slow=200-1000`, to see that the page does not mind: so many milliseconds longer takes every frame of the physics. */
function slowness() {
  const [from, to] = (wishes.get("slow") ?? "").split("-").map(Number);
  return from > 0 ? [from, to > from ? to : from] : undefined;
}

async function start() {
  await init({ module_or_path: new URL("forerun_web_bg.wasm", import.meta.url) });
  tell("");
  const asked = wishes.get("scene") || "dominoes";
  const { scene, text } = await wished(asked).catch((error) => {
    tell(`${asked} could not be fetched: ${error.message}.`);
    return { scene: "dominoes" };
  });
  listen();
  // Keys go to whatever has the focus.
  canvas.focus();
  forerun.run_page(scene, text, slowness());
}

/** The window library leaves its starting function by an exception; that is no error. */
const isError = (error) => !`${error?.message ?? error}`.includes("isn't actually an error");

/** What went wrong in the module, if it was that; there is none to ask before it is loaded. */
function panicMessage() {
  try {
    return forerun.panic_message();
  } catch {
    return undefined;
  }
}

function listen() {
  window.addEventListener("error", ({ error }) => {
    const panic = panicMessage();
    if ((panic || error instanceof WebAssembly.RuntimeError) && isError(error)) {
      tell(`The viewer has stopped by a mistake of its own; reload the page. It said: ${panic ?? error.message}`);
    }
  });
  canvas.addEventListener("webglcontextlost", () => {
    tell("The browser took the graphics card away from this page, as it does when memory is short or a driver begins anew. Reload the page.");
  });
  window.addEventListener("pagehide", () => forerun.keep_settings());
  document.addEventListener("visibilitychange", () => forerun.keep_settings());
  gestures(canvas);
  window.addEventListener("keydown", sort, { capture: true });
  window.addEventListener("keyup", sort, { capture: true });
  window.addEventListener("blur", letGo);
  window.addEventListener("dragover", (event) => event.preventDefault());
  window.addEventListener("drop", drop);
}

/** Whether a key means something to the viewer, which would keep the browser from doing what it does at it. */
function isOfViewer(event) {
  const { key, shiftKey } = event;
  if (key in MODIFIERS || event.getModifierState("AltGraph")) {
    return true;
  }
  if (event.ctrlKey || event.metaKey) {
    return !event.altKey && (shiftKey ? WITH_CTRL_SHIFT : WITH_CTRL).includes(key.toLowerCase());
  }
  return !event.altKey && !OF_BROWSER.test(key);
}

/** Leaves to the browser what is the browser's, and takes the command key of a Mac for Ctrl. */
function sort(event) {
  const { key, type } = event;
  if (key === "Meta" && IS_MAC) {
    press(type, "Control");
  }
  // What goes up has gone down before, be it with other keys.
  if (type === "keydown" && !isOfViewer(event)) {
    event.stopImmediatePropagation();
  } else if (event.metaKey) {
    event.preventDefault();
  }
}

/** The key that goes up while another window has the focus is not heard of here. */
function letGo() {
  Object.keys(MODIFIERS).forEach((key) => press("keyup", key));
}

const press = (type, key) => canvas.dispatchEvent(new KeyboardEvent(type, { key, code: MODIFIERS[key], bubbles: true }));

async function drop(event) {
  event.preventDefault();
  const file = event.dataTransfer?.files[0];
  if (!file) {
    return;
  }
  if (!SCENE_FILE.test(file.name)) {
    tell(`${file.name} is no scene: the name of a scene file ends in .toml or .json.`);
    return;
  }
  try {
    const text = await file.text();
    tell("");
    forerun.open_text(file.name, text);
  } catch (error) {
    tell(`${file.name} cannot be read: ${error.message}`);
  }
}

/** The state of the viewer, for scripts. */
window.forerun_state = () => JSON.parse(forerun.forerun_state());

const why = lacking();
if (why) {
  tell(why);
} else {
  start().catch((error) => {
    if (isError(error)) {
      tell(`The viewer cannot start: ${panicMessage() ?? error.message ?? error}`);
    }
  });
}
