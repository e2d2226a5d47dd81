"""A still of a scene as the viewer shows it, by headless Chromium:
    HIMC_BUILD=build python3 tests/viewer/still.py SCENE.himc OUT.png SECONDS [CAMERA]
        [WIDTH HEIGHT] [bare]
`bare` leaves out what is written over the stage. Time is stepped, so that a slow renderer gives
the same picture.
"""

import os
import sys
import time

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
from browser import Browser  # noqa: E402
from bridge import Viewer  # noqa: E402

LEAD = 2.5  # played before the picture, for the trails and the head's ringing (s)


def still(scene, out, seconds, camera="stage", width=1280, height=720, bare=False):
    browser = Browser(width, height + 143)  # the window's own frame
    try:
        browser.media(prefers_color_scheme="dark")
        with Viewer("--play", scene) as viewer:
            browser.open(f"http://127.0.0.1:{viewer.http}/")
            if not browser.wait("return !!(window.viewer && viewer.playback)", 60):
                raise RuntimeError("the page did not load the scene: " + "; ".join(browser.log()))
            browser.run("viewer.held = true")
            time.sleep(1)
            browser.run(
                "viewer.stage.quality = 1; document.body.classList.toggle('bare', arguments[2]);"
                "viewer.actions.camera(arguments[0]);"
                "viewer.playback.seek(arguments[1]); viewer.playback.play(true)",
                camera,
                1000 * (seconds - LEAD),
                bare,
            )
            browser.run(
                "for (let i = 0; i < 60 * arguments[0]; i++) viewer.step(1000 / 60, false);"
                "viewer.step(1, true)",
                LEAD,
            )
            time.sleep(1.5)
            browser.shot(out)
    finally:
        browser.close()


if __name__ == "__main__":
    if len(sys.argv) < 4:
        sys.exit(__doc__)
    words = [w for w in sys.argv[1:] if w != "bare"]
    still(
        words[0],
        words[1],
        float(words[2]),
        *words[3:4],
        *map(int, words[4:6]),
        bare="bare" in sys.argv,
    )
