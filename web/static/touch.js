// Two fingers on the canvas: as they go, the picture moves, as with the middle button of a mouse; as they part, it comes nearer, as with a wheel. One finger
// is the window library's, which makes the left button of it.

/** Of a wheel that brings e times nearer: one notch, of 100 pixels, brings nearer by the factor 0.88. */
const WHEEL = -100 / Math.log(1 / 0.88);

export function gestures(canvas) {
  /** Where the fingers are that are down. */
  const fingers = new Map();
  /** Where the two of them were last; none while there is one only, or no longer two. */
  let last;
  /** Whether there were two since the first came down: what goes on until the last is up is no other gesture. */
  let were = false;

  const pair = () => {
    const [a, b] = fingers.values();
    return { x: (a.x + b.x) / 2, y: (a.y + b.y) / 2, apart: Math.max(1, Math.hypot(a.x - b.x, a.y - b.y)) };
  };
  const mouse = (type, { x, y }, button) =>
    canvas.dispatchEvent(new PointerEvent(type, { pointerType: "mouse", button, clientX: x, clientY: y, bubbles: true, cancelable: true }));

  function begin() {
    [last, were] = [pair(), true];
    mouse("pointermove", last, -1);
    mouse("pointerdown", last, 1);
    // What the first finger has begun is left off, as soon as it has been seen to begin.
    requestAnimationFrame(() => requestAnimationFrame(() => {
      for (const type of ["keydown", "keyup"]) {
        canvas.dispatchEvent(new KeyboardEvent(type, { key: "Escape", code: "Escape", bubbles: true }));
      }
    }));
  }

  function go() {
    const now = pair();
    mouse("pointermove", now, -1);
    const deltaY = WHEEL * Math.log(now.apart / last.apart);
    if (deltaY !== 0) {
      canvas.dispatchEvent(new WheelEvent("wheel", { deltaY, clientX: now.x, clientY: now.y, bubbles: true, cancelable: true }));
    }
    last = now;
  }

  function end() {
    mouse("pointerup", last, 1);
    mouse("pointerout", last, -1);
    last = undefined;
  }

  function take(event) {
    const { type, pointerId, pointerType, clientX: x, clientY: y } = event;
    if (pointerType !== "touch" || event.target !== canvas) {
      return;
    }
    const isFirst = fingers.size === 0 || fingers.keys().next().value === pointerId;
    if (type === "pointerdown" || (type === "pointermove" && fingers.has(pointerId))) {
      fingers.set(pointerId, { x, y });
    } else if (type !== "pointermove" && last) {
      end();
    }
    if (type === "pointerdown" && fingers.size === 2 && !were) {
      begin();
    } else if (type === "pointermove" && last) {
      go();
    }
    // The window library hears of the first finger, when it comes and when it goes.
    if (type === "pointermove" ? were : !isFirst) {
      event.stopImmediatePropagation();
    }
    if (type === "pointerup" || type === "pointercancel") {
      fingers.delete(pointerId);
      were &&= fingers.size > 0;
    }
  }

  for (const type of ["pointerdown", "pointermove", "pointerup", "pointercancel"]) {
    window.addEventListener(type, take, { capture: true });
  }
}
