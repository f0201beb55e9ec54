"""Measures the sizes of pages and the time until they are ready: `python reference/page_times.py PROGRAM`.

Each page is opened three times in a headless Chromium, which draws in software; the fastest time counts. One body, with nearly 100,000
nodes on its surface, is solved to 1e-2.
"""

import json
import subprocess
import sys
import tempfile
from pathlib import Path

from browser import Browser

ROOT = Path(__file__).resolve().parent.parent
EXAMPLES = ("indentation", "circle", "two_cylinders", "ball")


def plate() -> dict:
    """A thin plate of 220 x 220 x 4 nodes under a ball."""

    def axis(length: float, divisions: int) -> dict:
        return {"points": [0, length], "divisions": [divisions]}

    ball = {"sphere": {"apex": [0.5, 0.5, 0.05], "radius": 1}}
    return {
        "title": "A ball pressed into a plate",
        "model": "space",
        "body": {"box": {"x": axis(1, 219), "y": axis(1, 219), "z": axis(0.05, 3), "element": "hex8"}},
        "material": {"young": 1e7, "poisson": 0.3},
        "supports": [{"on": {"boundary": "bottom"}, "x": 0, "y": 0, "z": 0}],
        "obstacles": [{"boundary": "top", "approach": "+z", "rule": "approach", "shape": ball}],
        "gap": -0.002,
    }


def main() -> int:
    program = Path(sys.argv[1]).resolve()
    with tempfile.TemporaryDirectory() as name, Browser() as browser:
        folder = Path(name)
        (folder / "plate.json").write_text(json.dumps(plate()))
        scene = ROOT / "examples/indentation.json"
        runs = [(f"solve {example}.json", ["solve", ROOT / f"examples/{example}.json"]) for example in EXAMPLES]
        runs += [
            ("sweep indentation.json, 22 events", ["sweep", scene, "--gaps=-0.01:-0.10:10"]),
            ("solve disc.json, a motion", ["solve", ROOT / "studies/impact/disc.json"]),
            ("solve, 98,552 nodes on the surface", ["solve", folder / "plate.json", "--accuracy", "1e-2", "--no-proof"]),
        ]
        for number, (what, arguments) in enumerate(runs):
            out = folder / str(number)
            subprocess.run([program, *arguments, "--out", out], check=True, capture_output=True)
            page = out / "report.html"
            seconds = min(browser.open(page) for _ in range(3))
            print(f"| {what} | {page.stat().st_size / 1e6:.2f} MB | {seconds:.2f} s |", flush=True)
    return 0


if __name__ == "__main__":
    sys.exit(main())
