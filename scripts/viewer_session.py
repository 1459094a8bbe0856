#!/usr/bin/env python3
"""Plays a session in the native viewer with mouse and keys, and checks by its state that everything took effect.

It needs a display (or Xvfb), xdotool and, for pictures, ImageMagick's `import`:

    cargo build --release
    xvfb-run -s "-screen 0 1280x720x24" scripts/viewer_session.py --pictures out/

Start, pause, scrub, throw, drag, undo and redo, the switch of the driver and another scene are real events of the X server; what came of them is
read from the report that `forerun view --report FILE` writes after every picture. One line a check; exit code 0 when all passed, 1 otherwise.
With --pictures, a folder gets one picture each of five scenes, and of the moments of the session.
"""

import argparse
import json
import os
import pathlib
import shutil
import subprocess
import sys
import tempfile
import time

ROOT = pathlib.Path(__file__).resolve().parent.parent
SIZE = (1280, 720)
# Software that draws without a graphics card takes its time.
PATIENCE_S = 90.0
# A body that nothing holds is lifted within this time.
LIFT_S = 8.0
# What panels may cover. Pixels from the left, the top, the right and the bottom.
MARGINS = (240, 130, 330, 200)
# Scene, keys, seconds until the picture is taken.
PICTURES = [
    ("dominoes:60", [], 3.0),
    ("pyramid:8", ["x"], 2.0),
    ("tori:6", ["g"], 1.5),
    ("rain:60", ["c", "c", "c"], 2.0),
    ("mugs:4", ["l"], 1.5),
]


class Failed(Exception):
    """The session cannot go on."""


class Viewer:
    """A viewer in a window, and the report that it writes."""

    def __init__(self, binary, scene, folder, out=None):
        self.out = out
        self.report_file = pathlib.Path(folder) / "report.json"
        self.report_file.unlink(missing_ok=True)
        size = f"{SIZE[0]}x{SIZE[1]}"
        command = [str(binary), "view", scene, "--size", size, "--report", str(self.report_file)]
        # Whatever the settings of this user are: the defaults.
        environment = dict(os.environ, FORERUN_CONFIG_DIR="")
        self.process = subprocess.Popen(command, env=environment, stderr=subprocess.PIPE, text=True)
        self.window = None

    def __enter__(self):
        self.wait("the scene plays", lambda state: state["stage"] == "playing" and state["pictures"] > 2)
        found = xdotool("search", "--name", "^forerun").split()
        if not found:
            raise Failed("no window is called forerun")
        self.window = found[0]
        xdotool("windowfocus", self.window)
        return self

    def __exit__(self, *_):
        self.process.terminate()
        try:
            self.process.wait(timeout=20)
        except subprocess.TimeoutExpired:
            self.process.kill()

    def state(self):
        """The last report; None before the first."""
        if self.process.poll() is not None:
            raise Failed(f"the viewer ended: {self.process.stderr.read().strip()}")
        try:
            state = json.loads(self.report_file.read_text())
        except (FileNotFoundError, json.JSONDecodeError):
            return None
        if state["stage"] == "failed":
            raise Failed(f"the scene failed: {state['failure']}")
        return state

    def wait(self, what, ready, patience_s=PATIENCE_S):
        """Waits until the state is as asked; the state then."""
        until = time.monotonic() + patience_s
        while time.monotonic() < until:
            state = self.state()
            if state is not None and ready(state):
                return state
            time.sleep(0.05)
        raise Failed(f"waited {patience_s:.0f} s: {what}; {json.dumps(self.state())}")

    def pictures(self, count=2):
        """Waits for some pictures more: what was pressed before has been seen then."""
        drawn = self.state()["pictures"]
        return self.wait(f"{count} pictures", lambda state: state["pictures"] >= drawn + count)

    def key(self, name):
        xdotool("key", name)
        return self.pictures()

    def move(self, pixel):
        xdotool("mousemove", "--window", self.window, str(round(pixel[0])), str(round(pixel[1])))

    def press(self, pixel):
        self.move(pixel)
        self.pictures(1)
        xdotool("mousedown", "1")
        return self.pictures()

    def drag_on(self, begin, end, steps=6):
        """Moves the pressed mouse in some steps, one a picture."""
        for i in range(1, steps + 1):
            part = i / steps
            self.move([a + (b - a) * part for a, b in zip(begin, end)])
            self.pictures(1)

    def release(self):
        xdotool("mouseup", "1")
        return self.pictures()

    def body(self, which=0):
        """A body that can be clicked at and that no panel covers; `which` of them, from the middle of the window."""
        left, top, right, bottom = MARGINS

        def clear(seen):
            x, y = seen["pixel"]
            return left < x < SIZE[0] - right and top < y < SIZE[1] - bottom

        bodies = [seen for seen in self.state()["play"]["in_sight"] if clear(seen)]
        if not bodies:
            raise Failed(f"no body is in sight: {self.state()['play']['in_sight']}")
        return bodies[which % len(bodies)]

    def picture(self, name):
        """Keeps a picture, where pictures are asked for; its file."""
        if self.out is None:
            return None
        path = self.out / f"{name}.png"
        subprocess.run(["import", "-window", self.window, str(path)], check=True)
        return path


def xdotool(*arguments):
    done = subprocess.run(["xdotool", *arguments], check=True, capture_output=True, text=True)
    return done.stdout


class Checks:
    """One line a check."""

    def __init__(self):
        self.failed = 0

    def __call__(self, fine, what, detail=""):
        print(f"{'ok    ' if fine else 'FAILED'} {what}{f' ({detail})' if detail else ''}", flush=True)
        self.failed += not fine


def start_and_pause(viewer, check):
    begin = viewer.state()["play"]["time_s"]
    state = viewer.wait("time goes on", lambda state: state["play"]["time_s"] > begin + 0.3)
    check(True, "start: the scene plays", f"{begin:.3f} s to {state['play']['time_s']:.3f} s")
    paused = viewer.key("space")["play"]
    later = viewer.pictures(4)["play"]
    still = paused["paused"] and later["time_s"] == paused["time_s"] and later["samples_hash"] == paused["samples_hash"]
    check(still, "pause: time and all bodies stand still", f"at {later['time_s']:.3f} s")


def scrub(viewer, check):
    viewer.wait("physics is ahead", lambda state: state["play"]["horizon_s"] > state["play"]["time_s"] + 1.0)
    strip = viewer.state()["strip"]
    if strip is None:
        check(False, "scrub: the timeline strip is not shown")
        return
    play = viewer.state()["play"]
    middle = strip["y"] + 0.5 * strip["height"]

    def pixel(time_s):
        part = (time_s - strip["from_s"]) / (strip["to_s"] - strip["from_s"])
        return [strip["x"] + part * strip["width"], middle]

    slack = 3.0 * (strip["to_s"] - strip["from_s"]) / strip["width"] + 0.02
    for what, to_s in [("the future", play["time_s"] + 0.8), ("the past", 0.5 * play["time_s"])]:
        begin, end = pixel(viewer.state()["play"]["time_s"]), pixel(to_s)
        viewer.press(begin)
        viewer.drag_on(begin, end)
        now = viewer.release()["play"]
        # The dominoes may all lie by then; in the past they stood.
        other = what == "the future" or now["samples_hash"] != play["samples_hash"]
        fine = abs(now["time_s"] - to_s) <= slack and other
        check(fine, f"scrub: the playhead is dragged into {what}", f"{now['time_s']:.3f} s where {to_s:.3f} s was asked")


def throw(viewer, check):
    viewer.key("t")
    before = viewer.state()["play"]
    viewer.press(viewer.body()["pixel"])
    state = viewer.wait("the throw is aimed", lambda state: state["play"]["aiming"] and state["play"]["preview"])
    preview = state["play"]["preview"]
    check(preview["frames"] > 10, "throw: a preview is there while it is aimed", f"{preview['frames']} frames")
    viewer.picture("throw")
    viewer.release()
    state = viewer.wait("the body is there", lambda state: state["play"]["bodies"] == before["bodies"] + 1)
    play = state["play"]
    check(play["thrown"] == preview["body"], "throw: the body is in the scene", f"body {play['thrown']}")
    check(play["undo"] == before["undo"] + 1 and play["undo_label"] == "throw", "throw: it can be taken back")


def lift(viewer, which):
    """Drags a body upwards by its spring, and how far it came; nothing where others lie on it, it is jammed, or has moved away from the mouse."""
    body = viewer.body(which)
    begin = body["pixel"]
    end = [begin[0] + 70.0, begin[1] - 90.0]
    viewer.press(begin)
    viewer.drag_on(begin, end, steps=8)
    play = viewer.pictures()["play"]
    if play["dragged"] is None:
        return play, 0.0
    # It may have come up already: where pictures are slow, the spring has pulled for seconds.
    lowest, until = body["position"][1], time.monotonic() + LIFT_S
    while time.monotonic() < until:
        play = viewer.state()["play"]
        height = play["selected_position"][1]
        lowest = min(lowest, height)
        if height > lowest + 0.1:
            return play, height - lowest
        viewer.pictures(1)
    return play, 0.0


def drag(viewer, check):
    viewer.key("q")
    viewer.key("space")
    for which in range(4):
        play, height = lift(viewer, which)
        if height > 0.0:
            break
        viewer.release()
        if viewer.state()["play"]["undo_label"] == "drag":
            viewer.key("ctrl+z")
    picked = play["dragged"] is not None and play["selected"] == [play["dragged"]]
    check(picked, "drag: the body under the mouse is picked and dragged", f"body {play['dragged']}")
    viewer.picture("drag")
    viewer.release()
    viewer.key("space")
    check(height > 0.0, "drag: the spring lifts it", f"{height:.2f} m")
    play = viewer.state()["play"]
    check(play["undo_label"] == "drag" and play["dragged"] is None, "drag: it is one step to take back")


def undo(viewer, check):
    before = viewer.state()["play"]
    viewer.key("ctrl+z")
    play = viewer.state()["play"]
    check(play["undo"] == before["undo"] - 1 and play["redo"] == 1, "undo: the drag is taken back", play["redo_label"])
    viewer.key("ctrl+z")
    state = viewer.wait("the thrown body is gone", lambda state: state["play"]["bodies"] == before["bodies"] - 1)
    check(state["play"]["redo"] == 2, "undo: the thrown body is gone", f"{state['play']['bodies']} bodies")
    viewer.key("ctrl+y")
    state = viewer.wait("it is back", lambda state: state["play"]["bodies"] == before["bodies"])
    check(state["play"]["undo_label"] == "throw", "redo: it is back")


def remove(viewer, check):
    viewer.press(viewer.body()["pixel"])
    viewer.release()
    play = viewer.state()["play"]
    check(len(play["selected"]) == 1, "pick: a click picks a body", f"body {play['selected']}")
    viewer.key("Delete")
    viewer.wait("it is gone", lambda state: state["play"]["bodies"] == play["bodies"] - 1)
    check(True, "remove: the selected body is gone")
    viewer.key("ctrl+z")
    viewer.wait("it is back", lambda state: state["play"]["bodies"] == play["bodies"])
    check(True, "undo: it is back")


def switch(viewer, check):
    before = viewer.key("k")["play"]
    check(before["coupled"] and before["undo"] == 0, "coupled: the traditional driver goes on", f"from {before['time_s']:.3f} s")
    viewer.key("space")
    viewer.picture("coupled")
    viewer.wait("it steps", lambda state: state["play"]["time_s"] > before["time_s"] + 0.05)
    viewer.key("k")
    state = viewer.wait("physics is ahead again", lambda state: state["play"]["horizon_s"] > state["play"]["time_s"] + 0.5)
    check(not state["play"]["coupled"], "coupled: and back to the one that runs ahead")


def session(binary, folder, out, check):
    with Viewer(binary, "dominoes:40", folder, out) as viewer:
        for part in [start_and_pause, scrub, throw, drag, undo, remove, switch]:
            part(viewer, check)


def pictures(binary, folder, out, check):
    for scene, keys, seconds in PICTURES:
        with Viewer(binary, scene, folder, out) as viewer:
            for key in keys:
                viewer.key(key)
            viewer.wait("the moment has come", lambda state: state["play"]["time_s"] >= seconds)
            path = viewer.picture(scene.split(":")[0])
            check(path.stat().st_size > 10_000, f"picture: {path}")


def main():
    arguments = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    arguments.add_argument("--binary", type=pathlib.Path, default=ROOT / "target/release/forerun")
    arguments.add_argument("--pictures", type=pathlib.Path, help="a folder for pictures of five scenes")
    arguments.add_argument("--only-pictures", action="store_true", help="no session")
    asked = arguments.parse_args()
    if shutil.which("xdotool") is None:
        sys.exit("xdotool is missing")
    check = Checks()
    if asked.pictures:
        asked.pictures.mkdir(parents=True, exist_ok=True)
    with tempfile.TemporaryDirectory() as folder:
        try:
            if not asked.only_pictures:
                session(asked.binary, folder, asked.pictures, check)
            if asked.pictures:
                pictures(asked.binary, folder, asked.pictures, check)
        except (Failed, subprocess.CalledProcessError) as error:
            check(False, str(error))
    sys.exit(1 if check.failed else 0)


if __name__ == "__main__":
    main()
