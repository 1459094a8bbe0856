// Files of the web page: the browser's storage, downloads, and its dialog for a scene.

const KEY = "forerun-viewer";

/** In a page narrower than this, the panels of tools and of the selection would leave nothing of the picture. Pixels. */
const TOOLS_FROM = 600;
const INSPECTOR_FROM = 900;

export function load() {
  // A browser may forbid storage altogether.
  try { return localStorage.getItem(KEY) ?? usual(); } catch { return usual(); }
}

/** What a newcomer gets: the system's theme, and on a phone only the picture and its timeline. */
function usual() {
  const theme = matchMedia("(prefers-color-scheme: light)").matches ? "light" : "dark";
  const open = { tools: innerWidth >= TOOLS_FROM, inspector: innerWidth >= INSPECTOR_FROM };
  return JSON.stringify({ view: { theme, open } });
}

export function keep(text) {
  try { localStorage.setItem(KEY, text); } catch { /* then nothing is kept */ }
}

export function download(name, content) {
  // The memory of the module may move: the copy is the browser's.
  const url = URL.createObjectURL(new Blob([content.slice()]));
  const link = Object.assign(document.createElement("a"), { href: url, download: name });
  link.click();
  setTimeout(() => URL.revokeObjectURL(url), 10000);
}

export class Dialog {
  #decided = false;
  #name = undefined;
  #text = undefined;

  constructor() {
    const input = Object.assign(document.createElement("input"), { type: "file", accept: ".toml,.json" });
    input.addEventListener("cancel", () => { this.#decided = true; });
    input.addEventListener("change", () => this.#read(input.files[0]));
    input.click();
  }

  async #read(file) {
    try {
      this.#text = await file?.text();
      this.#name = file?.name;
    } catch (error) {
      alert(`${file.name} cannot be read: ${error.message}`);
    }
    this.#decided = true;
  }

  decided() { return this.#decided; }
  name() { return this.#name; }
  text() { return this.#text; }
}
