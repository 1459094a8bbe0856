// Starts the viewer in the page's canvas. Everything else is in the WebAssembly module and in worker.js.

import init, * as forerun from "./forerun_web.js";

const notice = document.getElementById("notice");

function tell(message) {
  notice.textContent = message;
  notice.hidden = !message;
}

window.addEventListener("error", ({ error, message }) => {
  // The window library leaves its starting function by an exception; that is no error.
  if (!`${error?.message ?? message}`.includes("isn't actually an error")) {
    tell(lastPanic() ?? `${error?.message ?? message}`);
  }
});

/** The message of the last panic; there is none before the module is there. */
function lastPanic() {
  try {
    return forerun.last_panic();
  } catch {
    return undefined;
  }
}

/** The state of the viewer, for scripts. */
window.forerun_state = () => JSON.parse(forerun.forerun_state());

window.addEventListener("dragover", (event) => event.preventDefault());
window.addEventListener("drop", async (event) => {
  event.preventDefault();
  const file = event.dataTransfer?.files[0];
  if (file) {
    forerun.open_text(file.name, await file.text());
  }
});

const wishes = new URLSearchParams(location.search);
// To see that the page does not mind: `?slow=200-1000` makes every frame of the physics so many milliseconds slower.
const slow = wishes.get("slow")?.split("-").map(Number);

try {
  await init({ module_or_path: new URL("forerun_web_bg.wasm", import.meta.url) });
  tell("");
  // Keys go to whatever has the focus.
  document.querySelector("canvas").focus();
  forerun.run_page(wishes.get("scene") ?? "dominoes", slow ? [slow[0], slow[1] ?? slow[0]] : undefined);
} catch (error) {
  if (!`${error}`.includes("isn't actually an error")) {
    tell(`The viewer cannot start: ${lastPanic() ?? error.message ?? error}. It needs a browser with WebAssembly SIMD and WebGL 2.`);
  }
}
