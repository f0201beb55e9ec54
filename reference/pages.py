"""Tests `report.html` in a real browser: `SIGNORINI=target/debug/signorini python -m unittest reference/pages.py`.

The program writes a page of every kind, and a headless Chromium opens it. A page must cause no error and no network request; its
sliders must change the view; its numbers must be those of the report; and its body must look like the picture that the program draws.
"""

import base64
import csv
import hashlib
import json
import os
import re
import subprocess
import tempfile
import unittest
from pathlib import Path

from browser import Browser

ROOT = Path(__file__).resolve().parent.parent
PROGRAM = Path(os.environ.get("SIGNORINI", ROOT / "target/debug/signorini")).resolve()
EXAMPLES = ROOT / "examples"
PHONE = (390, 844)


def run(*arguments: object) -> dict:
    """Runs the program and returns its JSON report. An answer that is not certified is allowed; any other error is not."""
    done = subprocess.run([PROGRAM, *map(str, arguments), "--format", "json"], capture_output=True, text=True, check=False)
    if done.returncode not in (0, 4):
        raise AssertionError(f"exit code {done.returncode}: {done.stderr}")
    return json.loads(done.stdout)


LOOK = """
(async () => {
  const image = new Image();
  image.src = "data:image/png;base64,%s";
  await image.decode();
  const canvas = new OffscreenCanvas(image.width, image.height), brush = canvas.getContext("2d");
  brush.drawImage(image, 0, 0);
  const { data } = brush.getImageData(0, 0, image.width, image.height), right = Math.round(image.width * %f);
  // Saturated pixels belong to the field; frames, meshes and texts are grey.
  let box = [1e9, 1e9, -1, -1];
  const rows = new Map(), columns = new Map(), add = (map, key) => map.set(key, (map.get(key) || 0) + 1);
  const coloured = (x, y) => {
    const [r, g, b] = data.subarray(4 * (y * image.width + x));
    return Math.max(r, g, b) - Math.min(r, g, b) > 50 && !(r > 190 && g < 130 && b < 130);
  };
  for (let y = 0; y < image.height * %f; y++) for (let x = 0; x < right; x++) if (coloured(x, y)) { add(rows, y); add(columns, x); }
  const many = [...rows.values()].reduce((a, b) => Math.max(a, b), 0), tall = [...columns.values()].reduce((a, b) => Math.max(a, b), 0);
  const ys = [...rows].filter(([, n]) => n > 0.3 * many).map(([y]) => y), xs = [...columns].filter(([, n]) => n > 0.3 * tall).map(([x]) => x);
  box = [Math.min(...xs), Math.min(...ys), Math.max(...xs), Math.max(...ys)];
  const colours = [];
  for (const v of [0.15, 0.4, 0.65, 0.9]) for (const u of [0.1, 0.3, 0.5, 0.7, 0.9]) {
    const sum = [0, 0, 0];
    for (let j = -3; j <= 3; j++) for (let i = -3; i <= 3; i++) {
      const x = Math.round(box[0] + u * (box[2] - box[0])) + i, y = Math.round(box[1] + v * (box[3] - box[1])) + j;
      for (let k = 0; k < 3; k++) sum[k] += data[4 * (y * image.width + x) + k] / 49;
    }
    colours.push(sum);
  }
  return { width: box[2] - box[0] + 1, height: box[3] - box[1] + 1, colours };
})()
"""


def disc(is_part: bool) -> dict:
    """A disc under a plate that presses, or the half of it that a plane of symmetry leaves."""
    supports = [{"on": {"boundary": "upper"}, "y": 0}] + ([] if is_part else [{"on": {"point": [0, 10]}, "x": 0}])
    return {
        "model": "plane-strain",
        "units": {"length": "mm", "force": "N"},
        "body": {
            "disc": {"centre": [0, 10], "radius": 10, "symmetric": is_part, "element": "q4", "zone": {"width": 1, "divisions": 8}}
        },
        "material": {"young": 2000, "poisson": 0.3},
        "symmetry": ["x"] if is_part else [],
        "supports": supports,
        "obstacles": [
            {
                "boundary": "lower",
                "approach": "-y",
                "force": 100,
                "shape": {"plane": {"point": [0, 0], "normal": [0, -1]}},
            }
        ],
    }


def block(planes: str, is_between: bool) -> dict:
    """A block under a ball or between two balls, or the part of it that planes of symmetry leave."""

    def along(axis: str, low: int) -> dict:
        low = 0 if axis in planes else low
        return {"points": [low, 1], "divisions": [4 * (1 - low)]}

    def ball(boundary: str, approach: str, z: int) -> dict:
        shape = {"sphere": {"apex": [0, 0, z], "radius": 2}}
        return {"boundary": boundary, "approach": approach, "force": 40, "shape": shape}

    supports = [] if is_between else [{"on": {"boundary": "bottom"}, "z": 0}]
    if not planes:
        supports += [{"on": {"point": [0, y, 0]}, "x": 0} for y in (-1, 1)] + [{"on": {"point": [1, 0, 0]}, "y": 0}]
    if not planes and is_between:
        supports += [{"on": {"point": point}, "z": 0} for point in ([0, 1, 0], [1, 0, 0], [0, -1, 0])]
    return {
        "model": "space",
        "units": {"length": "mm", "force": "N"},
        "body": {"box": {"x": along("x", -1), "y": along("y", -1), "z": along("z", -1 if is_between else 0), "element": "hex8"}},
        "material": {"young": 1000, "poisson": 0.3},
        "symmetry": list(planes),
        "supports": supports,
        "obstacles": [ball("top", "+z", 1)] + ([ball("bottom", "-z", -1)] if is_between and not planes else []),
    }


def half_ball(planes: str) -> dict:
    """Half of a ball on a plate, or the part of it that planes of symmetry leave."""
    centre = [{"on": {"point": [0, 0, 10]}, "x": 0, "y": 0}, {"on": {"point": [10, 0, 10]}, "y": 0}]
    zone = {"width": 1, "divisions": 2, "growth": 2}
    return {
        "model": "space",
        "units": {"length": "mm", "force": "N"},
        "body": {"half-ball": {"half": "lower", "centre": [0, 0, 10], "radius": 10, "symmetric": list(planes), "zone": zone}},
        "material": {"young": 2000, "poisson": 0.3},
        "symmetry": list(planes),
        "supports": [{"on": {"boundary": "cut"}, "z": 0}, *([] if planes else centre)],
        "obstacles": [
            {"boundary": "round", "approach": "-z", "force": 100, "shape": {"plane": {"point": [0, 0, 0], "normal": [0, 0, -1]}}}
        ],
    }


def at_gap(scene: dict) -> dict:
    """The scene with obstacles at a prescribed place."""
    obstacles = [{key: value for key, value in obstacle.items() if key != "force"} for obstacle in scene["obstacles"]]
    return {**scene, "obstacles": obstacles, "gap": -0.02}


class Pages(unittest.TestCase):
    @classmethod
    def setUpClass(cls) -> None:
        cls.browser = Browser()
        cls.addClassCleanup(cls.browser.close)
        folder = tempfile.TemporaryDirectory()
        cls.addClassCleanup(folder.cleanup)
        cls.folder = Path(folder.name)
        cls.made = {}

    def page(self, command: str, scene: Path, *options: object) -> tuple[Path, dict]:
        """Runs a command, and returns its page and its report."""
        key = (command, str(scene), options)
        if key not in self.made:
            out = self.folder / f"out-{len(self.made)}"
            self.made[key] = (out / "report.html", run(command, scene, *options, "--out", out))
        return self.made[key]

    def opened(self, page: Path, **how: object) -> Browser:
        self.browser.open(page, **how)
        self.assertEqual(self.browser.faults(), [])
        return self.browser

    def slide(self, selector: str, value: float) -> None:
        """Moves a slider as a user does."""
        self.browser.ask(
            f"(() => {{ const it = document.querySelector({json.dumps(selector)}); it.value = {value};"
            " it.dispatchEvent(new Event('input', { bubbles: true })); })()"
        )
        self.browser.frame()

    def drawn(self, view: str) -> str:
        """Returns the drawn surface of a view, without its overlay."""
        self.browser.frame()
        return self.browser.ask(f"View.all.find(view => view.host.matches({json.dumps(view)})).under.toDataURL()")

    def text(self, selector: str) -> str:
        return self.browser.ask(f"document.querySelector({json.dumps(selector)}).textContent")

    def look(self, png: bytes, share: float, height: float = 1.0) -> dict:
        """Returns the size of the coloured body in a picture, and its colours."""
        # An empty page, so that no script or style of another page interferes.
        self.browser.send("Page.navigate", url="about:blank")
        return self.browser.ask(LOOK % (base64.b64encode(png).decode(), share, height))


class Answers(Pages):
    def test_the_page_of_an_answer_has_the_numbers_of_the_report(self) -> None:
        scene = EXAMPLES / "indentation.json"
        page, report = self.page("solve", scene)
        browser = self.opened(page)
        text = browser.ask("document.body.innerText")
        self.assertIn(f"{report['contact']['count']} closed rows", text)
        self.assertIn(hashlib.sha256(scene.read_bytes()).hexdigest(), text)
        for name in ("stationarity", "penetration", "supports[0]", "linux"):
            self.assertIn(name, text)
        self.assertEqual(browser.ask("signorini.data.report.contact.force"), report["contact"]["force"])
        closed = browser.ask("Array.from(signorini.data.contact.closed)")
        self.assertEqual(sum(closed), report["contact"]["count"])
        peak = browser.ask("Math.max(...signorini.data.contact.pressure)")
        self.assertEqual(peak, report["contact"]["pressure_max"])

    def numbers_shown(self, command: str, scene: dict, *options: str) -> dict[str, list[float]]:
        """Returns the numbers of each line of a page that does not name the meshed part: entries, cells, sentences, axes of plots."""
        path = self.folder / f"shown-{len(self.made)}.json"
        path.write_text(json.dumps({"title": "A part and its whole", **scene}))
        page, _ = self.page(command, path, *options)
        lines = self.opened(page).ask(
            """Array.from(document.querySelectorAll("main, section")).flatMap(own => {
              const title = own.querySelector(":scope > h2")?.textContent ?? "",
                all = query => Array.from(own.querySelectorAll(query)).filter(it => it.closest("main, section") === own);
              const list = all("dt").map(dt => [title, dt.textContent, dt.nextElementSibling.textContent]);
              const cells = all("tbody tr").flatMap(tr => {
                const headings = tr.closest("table").tHead.rows[0].cells;
                return Array.from(tr.cells, (cell, i) => [title, `${tr.cells[0].textContent}, ${headings[i].textContent}`, cell.textContent]);
              });
              const words = all("p, summary, .slider").map(it => [title, "", it.textContent]);
              const plots = all("svg[aria-label]").map(svg => [
                title, svg.ariaLabel, Array.from(svg.querySelectorAll("text"), text => text.textContent).join(" "),
              ]);
              return [...list, ...cells, ...words, ...plots];
            })"""
        )
        self.assertTrue(not scene["symmetry"] or any("pictures are of the meshed part" in text for _, _, text in lines))
        number = re.compile(r"(?<![\w\[])[-+]?\d+(?:\.\d+)?(?:e[-+]?\d+)?")
        shown = {}
        for title, label, text in lines:
            # In these lines the closed rows and the factor to the whole belong to the part, and the other numbers to the whole.
            text = re.sub(r"\d+ closed rows?( of the meshed part)?|,? of the whole body, \d+ times the meshed part", "", text)
            label = re.sub(r" and its (\d+ )?mirror images?", "", label)
            if title == "About this page" or (scene["symmetry"] and "of the meshed part" in title + label + text):
                continue
            shown[f"{title}: {label or number.sub('#', text)}"] = [float(value) for value in number.findall(text)]
        return {line: numbers for line, numbers in shown.items() if numbers}

    def test_a_part_shows_the_numbers_of_the_whole(self) -> None:
        pairs = {
            "half of a disc": (disc(True), disc(False)),
            "quarter of a block": (block("xy", False), block("", False)),
            "eighth of a block": (block("xyz", True), block("", True)),
            "quarter of a half ball": (half_ball("xy"), half_ball("")),
        }
        gaps = ("sweep", "--gaps=-0.02:-0.05:2")
        for name, (part, whole) in pairs.items():
            forces = ("sweep", "--forces=20:40:2")
            for command, *options in (("solve",), ("compare",), gaps, *((forces,) if len(whole["obstacles"]) == 1 else ())):
                with self.subTest(f"{name}, {command} {options}"):
                    make = at_gap if options == [gaps[1]] else dict
                    ours, exact = (self.numbers_shown(command, make(scene), *options) for scene in (part, whole))
                    self.assertGreater(sum(map(len, ours.values())), 15, ours)
                    # The components of a resultant that cancel are rounding beside its force.
                    forces_of = [abs(value) for line, numbers in ours.items() if line.startswith("Resultants: ") for value in numbers]
                    for line, numbers in ours.items():
                        self.assertIn(line, exact)
                        self.assertEqual(len(numbers), len(exact[line]), f"{line}: {numbers} {exact[line]}")
                        rounding = 1e-9 * max(forces_of, default=0.0) if line.startswith("Resultants: ") else 0.0
                        for value, expected in zip(numbers, exact[line], strict=True):
                            if max(abs(value), abs(expected)) > rounding:
                                self.assertLessEqual(abs(value - expected), 2e-6 * abs(expected), f"{line}: {numbers} {exact[line]}")

    def test_the_table_of_obstacles_has_their_uncertainties(self) -> None:
        between = disc(True)
        between["body"]["disc"]["centre"] = [0, 0]
        between["supports"] = [{"on": {"point": [0, 0]}, "y": 0}]
        below = dict(between["obstacles"][0], shape={"plane": {"point": [0, -10], "normal": [0, -1]}})
        above = dict(below, boundary="upper", approach="+y", shape={"plane": {"point": [0, 10], "normal": [0, 1]}})
        between["obstacles"] = [below, above]
        path = self.folder / "between.json"
        path.write_text(json.dumps(between))
        page, report = self.page("solve", path)
        cells = self.opened(page).ask(
            "Array.from(document.querySelectorAll('#answer tbody tr'), tr => Array.from(tr.cells, cell => cell.textContent))"
        )
        question = self.text("#question")
        self.assertEqual(question.count("pressed by 100 N"), 2, question)
        self.assertNotIn("the shift of every obstacle", question)
        for row, one in zip(cells, report["contact"]["obstacles"], strict=True):
            estimate = one["estimate"]
            for cell, value, off in (
                (row[3], one["pressure_max"], estimate["pressure_uncertainty"]),
                (row[4], estimate["width"], estimate["width_uncertainty"]),
            ):
                shown, shown_off = map(float, cell.split(" ± "))
                self.assertLessEqual(abs(shown - value), 1e-5 * value, row)
                self.assertLessEqual(abs(shown_off - off), 0.05 * off, row)

    def test_a_sweep_between_two_plates_shows_each_plate(self) -> None:
        between = disc(True)
        between["body"]["disc"]["centre"] = [0, 0]
        between["supports"] = [{"on": {"point": [0, 0]}, "y": 0}]
        below = {"boundary": "lower", "approach": "-y", "shape": {"plane": {"point": [0, -10], "normal": [0, -1]}}}
        above = {"boundary": "upper", "approach": "+y", "shape": {"plane": {"point": [0, 10.02], "normal": [0, 1]}}}
        between["obstacles"] = [below, above]
        path = self.folder / "plates.json"
        path.write_text(json.dumps(between))
        page, report = self.page("sweep", path, "--gaps=-0.05:-0.1:3")
        tables = self.opened(page).ask(
            "Array.from(document.querySelectorAll('#points table'), table => Array.from(table.rows, "
            "row => Array.from(row.cells, cell => cell.textContent)))"
        )
        of_gaps, of_plates = tables[0], tables[1]
        self.assertNotIn("force", " ".join(of_gaps[0]))
        expected = [(point["gap"], one) for point in report["points"] for one in point["contact"]["obstacles"]]
        for row, (gap, one) in zip(of_plates[1:], expected, strict=True):
            self.assertEqual((float(row[0]), row[1]), (gap, one["of"]))
            for cell, value in zip(row[2:4], (one["force"], one["pressure_max"]), strict=True):
                self.assertLessEqual(abs(float(cell.split(" ± ")[0]) - value), 1e-5 * value, row)
        # No sum over both plates stands anywhere.
        total = f"{report['points'][-1]['contact']['force']:.6g}"
        self.assertNotIn(total[:5], self.text("#points") + self.text("#answer"))

    def test_sliders_change_the_picture(self) -> None:
        page, _ = self.page("solve", EXAMPLES / "indentation.json", "--method", "active-set")
        browser = self.opened(page)
        before = self.drawn("#answer .view")
        self.slide("#answer input[aria-label='scale of the displacement']", 3)
        self.assertEqual(self.text("#answer .controls output"), "3")
        self.assertNotEqual(self.drawn("#answer .view"), before)
        words, picture = self.text("#search-facts"), self.drawn("#search .view")
        self.slide("#search .slider input[type=range]", 1)
        self.assertNotEqual(self.text("#search-facts"), words)
        self.assertNotEqual(self.drawn("#search .view"), picture)
        self.assertEqual(browser.faults(), [])

    def test_keys_turn_a_body_in_space_and_the_pointer_shows_values(self) -> None:
        page, _ = self.page("solve", EXAMPLES / "ball.json")
        browser = self.opened(page)
        before = self.drawn("#answer .view")
        browser.ask("document.querySelector('#answer .top').focus()")
        browser.send("Input.dispatchKeyEvent", type="keyDown", key="ArrowRight")
        browser.frame()
        self.assertNotEqual(self.drawn("#answer .view"), before)
        place = browser.ask(
            "(() => { const v = signorini.answer.view, p = v.place(v.vertex(0)), b = v.over.getBoundingClientRect();"
            " v.over.scrollIntoView(); const c = v.over.getBoundingClientRect(); return [c.x + p[0], c.y + p[1]]; })()"
        )
        browser.send("Input.dispatchMouseEvent", type="mouseMoved", x=place[0], y=place[1])
        self.assertIn("node ", self.text("#answer .view .tip"))
        self.assertIn("von Mises", self.text("#answer .view .tip"))
        self.assertEqual(browser.faults(), [])

    def test_the_body_looks_like_the_still_picture_with_and_without_webgl(self) -> None:
        page, _ = self.page("solve", EXAMPLES / "indentation.json")
        # The first of three panels.
        still = self.look((page.parent / "contact.png").read_bytes(), 0.36, 0.75)
        for fragment in ("", "#painter"):
            with self.subTest(fragment):
                browser = self.opened(page, fragment=fragment)
                browser.ask("signorini.answer.view.mesh = false; signorini.answer.marksOpen = false; 1")
                self.slide("#answer input[aria-label='scale of the displacement']", 0)
                seen = self.look(browser.picture("#answer .view"), 1.0)
                self.assertGreater(seen["width"], 300)
                ratio = seen["width"] / seen["height"] * still["height"] / still["width"]
                self.assertAlmostEqual(ratio, 1.0, delta=0.04)
                off = [max(abs(a - b) for a, b in zip(*pair, strict=True)) for pair in zip(seen["colours"], still["colours"], strict=True)]
                # A few points may differ under the obstacle and its shade.
                self.assertLess(sorted(off)[len(off) * 3 // 4], 24, off)

    def test_the_numbers_stand_above_the_pictures(self) -> None:
        ball = ROOT / "studies/impact/bouncing_bar.json"
        for command, scene, *options in (("solve", EXAMPLES / "ball.json"), ("solve", ball), ("sweep", EXAMPLES / "indentation.json", "--gaps=-0.01:-0.10:4")):
            page, _ = self.page(command, scene, *options)
            browser = self.opened(page)
            numbers = "document.querySelector('#answer dl, #facts')"
            first = f"{numbers}.compareDocumentPosition(document.querySelector('canvas')) & Node.DOCUMENT_POSITION_FOLLOWING"
            self.assertTrue(browser.ask(first), f"{command} {scene.name}")

    def test_an_obstacle_is_rigid_and_stays_with_its_contact_when_the_displacement_is_magnified(self) -> None:
        page, _ = self.page("solve", EXAMPLES / "gallery/ring.json")
        browser = self.opened(page)
        self.slide("#answer input[aria-label='scale of the displacement']", 8)
        # The lower plate: its outline is shifted as a whole, to the closed node.
        shift, plate, node = browser.ask(
            "(() => { const { answer: p, data } = signorini, o = data.question.obstacles, k = o.findIndex(it => it.approach[1] < 0);"
            " const row = p.frame.rows.find(row => data.rows.obstacles[row] === k && p.frame.closed[row]);"
            " return [p.shiftOf(k), o[k].outline[1], p.view.vertex(data.rows.vertices[row])[1]]; })()"
        )
        self.assertAlmostEqual(plate + shift[1], node, delta=2e-3)
        self.assertGreater(shift[1], 0.5)

    def test_the_mark_of_a_closed_row_is_over_those_of_open_rows(self) -> None:
        # Every node of the ring has a row of each plate.
        page, report = self.page("solve", EXAMPLES / "gallery/ring.json")
        kinds = self.opened(page).ask("signorini.answer.marks[1]")
        self.assertEqual(sum(kinds), report["contact"]["count"])
        self.assertEqual(kinds, sorted(kinds))

    def test_closed_rows_that_are_close_are_seen(self) -> None:
        page, report = self.page("solve", EXAMPLES / "two_cylinders.json")
        browser = self.opened(page)
        browser.frame()
        seen = browser.ask(
            "(() => { const { view, marks: [vertices, kinds] } = signorini.answer, brush = view.over.getContext('2d'),"
            " ratio = view.over.width / view.over.clientWidth, wanted = channels(view.ink('closed')).map(part => 255 * part);"
            " return vertices.filter((vertex, i) => { const [x, y] = view.place(view.vertex(vertex)).map(at => Math.floor(ratio * at));"
            " const { data } = brush.getImageData(x, y, 1, 1);"
            " return kinds[i] === 1 && wanted.every((part, k) => Math.abs(data[k] - part) < 3); }).length; })()"
        )
        self.assertEqual(seen, report["contact"]["count"])

    def test_the_legend_names_undecided_rows_only_if_there_are_some(self) -> None:
        page, report = self.page("solve", EXAMPLES / "ball.json")
        self.assertEqual(report["proven"]["undecided"], [])
        self.opened(page)
        self.assertNotIn("undecided", self.text("#answer .legend"))

    def test_the_limits_of_the_colours_are_set_by_hand(self) -> None:
        page, _ = self.page("solve", EXAMPLES / "ball.json")
        browser = self.opened(page)
        before, ends = self.drawn("#answer .view"), browser.ask("signorini.answer.view.range")
        field = "#answer input[aria-label='highest value of the colours']"
        browser.ask(f"(() => {{ const it = document.querySelector({json.dumps(field)}); it.value = 1e5; it.dispatchEvent(new Event('change')); }})()")
        self.assertEqual(browser.ask("signorini.answer.view.range[1]"), 1e5)
        self.assertIn("above the scale: up to", self.text("#answer .bar"))
        self.assertNotEqual(self.drawn("#answer .view"), before)
        browser.ask("document.querySelector('#answer .bar button').click()")
        self.assertEqual(browser.ask("signorini.answer.view.range"), ends)

    def test_the_answer_along_a_line_is_plotted_as_it_stands_in_its_table(self) -> None:
        page, _ = self.page("solve", EXAMPLES / "indentation.json", "--along", "0,0.5:1,0.5", "--along", "0.5,-1:0.5,2", "--along", "7,7:8,8")
        browser = self.opened(page)
        with (page.parent / "along.csv").open(newline="") as file:
            rows = list(csv.DictReader(file))
        for line, columns in [(0, ["von_mises", "pressure"]), (1, ["von_mises", "u_y"])]:
            for column in columns:
                browser.ask(
                    f"(() => {{ const s = document.querySelectorAll('#along select')[{line}];"
                    f" s.value = [...s.options].find(o => o.text === '{column}').value; s.dispatchEvent(new Event('change')); }})()"
                )
                browser.frame()
                unit = "m" if column == "u_y" else "Pa"
                self.assertIn(f"{column} [{unit}]", self.text(f"#along div.plotted:nth-of-type({line + 1})"))
                values = [float(row[f"{column} [{unit}]"]) for row in rows if row["line"] == str(line)]
                path = browser.ask(f"document.querySelectorAll('#along svg path')[{line}].getAttribute('d')")
                heights = [float(point.split()[1]) for point in re.findall(r"[ML]([^ML]+)", path)]
                self.assertEqual(len(heights), len(values))
                # Up in the plot is a larger value: the drawn heights are a linear function of the values.
                spread = max(values) - min(values)
                scale = (min(heights) - max(heights)) / spread
                for height, value in zip(heights, values):
                    self.assertAlmostEqual(height, max(heights) + scale * (value - min(values)), delta=0.2)
        # Off the contact there is no pressure to choose.
        self.assertNotIn("pressure", browser.ask("document.querySelectorAll('#along select')[1].innerText"))
        self.assertIn("meets no body", self.text("#along"))

    def test_a_section_shows_the_stress_inside_with_and_without_webgl(self) -> None:
        page, _ = self.page("solve", EXAMPLES / "ball.json")
        for fragment in ("", "#painter"):
            browser = self.opened(page, fragment=fragment)
            before = self.drawn("#answer .view")
            browser.ask(
                "(() => { const s = [...document.querySelectorAll('#answer select')].at(-1); s.value = 'x'; s.dispatchEvent(new Event('input')); })()"
            )
            self.assertNotEqual(self.drawn("#answer .view"), before)
            # The area of the section of a box of 1 x 1 x 0.5, and a von Mises stress inside that no surface has.
            area, peak = browser.ask(
                "(() => { const { places: p, values, order: o } = capOf(signorini.answer.view); let area = 0;"
                " for (let i = 0; i < o.length; i += 3) { const [a, b, c] = [0, 1, 2].map(k => [p[3 * o[i + k] + 1], p[3 * o[i + k] + 2]]);"
                " area += Math.abs((b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])) / 2; }"
                " return [area, Math.max(...values)]; })()"
            )
            self.assertAlmostEqual(area, 0.5, delta=1e-5)
            surface = browser.ask("Math.max(...signorini.answer.view.values.subarray(0, signorini.answer.shape.surface))")
            self.assertGreater(peak, surface)
            self.assertEqual(browser.faults(), [])

    def test_a_body_is_hidden_and_the_undeformed_body_shown(self) -> None:
        page, _ = self.page("solve", EXAMPLES / "two_cylinders.json")
        browser = self.opened(page)
        for name in ("undeformed body", "base"):
            before = self.drawn("#answer .view")
            browser.ask(f"[...document.querySelectorAll('#answer label')].find(it => it.textContent.trim() === {json.dumps(name)}).firstElementChild.click()")
            self.assertNotEqual(self.drawn("#answer .view"), before, name)
        self.assertEqual(browser.ask("signorini.answer.view.hidden.size"), 1)
        self.assertEqual(browser.faults(), [])

    def test_titles_and_names_are_shown_as_text(self) -> None:
        scene = json.loads((EXAMPLES / "indentation.json").read_text())
        scene["title"] = "</script><img src=x onerror=alert(1)> {{arrays}} & \"quoted\" <!--"
        scene["units"] = {"length": "<b>m</b>", "force": "</style>"}
        path = self.folder / "hostile.json"
        path.write_text(json.dumps(scene))
        page, _ = self.page("solve", path)
        browser = self.opened(page)
        self.assertEqual(browser.ask("document.querySelector('h1').textContent"), scene["title"])
        self.assertEqual(browser.ask("document.querySelectorAll('img, b').length"), 0)

    def test_a_phone_shows_the_page_without_scrolling_sideways(self) -> None:
        for scheme in ("light", "dark"):
            page, _ = self.page("compare", EXAMPLES / "indentation.json")
            browser = self.opened(page, size=PHONE, scheme=scheme)
            self.assertLessEqual(browser.ask("document.documentElement.scrollWidth"), PHONE[0])
        self.assertIn("penalty", self.text("#methods"))

    def test_a_printed_page_is_light_and_shows_the_surfaces(self) -> None:
        page, _ = self.page("solve", EXAMPLES / "ball.json")
        browser = self.opened(page, scheme="dark")
        paper = "getComputedStyle(document.documentElement).getPropertyValue('--paper')"
        middle = (
            "(() => { const o = View.all.find(view => view.host.matches('#question .view')).over, d = o.getContext('2d').getImageData(o.width / 2, o.height * 0.8, 1, 1).data;"
            " return d[0] + d[1] + d[2]; })()"
        )
        self.assertNotEqual(browser.ask(paper), "#ffffff")
        self.assertEqual(browser.ask(middle), 0)
        browser.ask("window.dispatchEvent(new Event('beforeprint')); 1")
        self.assertEqual(browser.ask(paper), "#ffffff")
        self.assertGreater(browser.ask(middle), 300)
        browser.ask("window.dispatchEvent(new Event('afterprint')); 1")
        self.assertEqual(browser.ask(middle), 0)

    def test_a_page_of_every_example_opens(self) -> None:
        for scene in sorted(EXAMPLES.glob("*.json")):
            with self.subTest(scene.name):
                page, _ = self.page("solve", scene)
                self.opened(page)


class Questions(Pages):
    def pixels(self, ink: str) -> int:
        """Counts the pixels of a colour of the page in the overlay of the question's body."""
        return self.browser.ask(
            """(() => { const view = View.all.find(view => view.host.matches("#question .view")), { over } = view;
            const wanted = channels(view.ink(%s)).map(part => Math.round(255 * part));
            const { data } = over.getContext("2d").getImageData(0, 0, over.width, over.height);
            let count = 0;
            for (let i = 0; i < data.length; i += 4) count += data[i + 3] > 250 && wanted.every((part, k) => Math.abs(data[i + k] - part) < 3);
            return count; })()"""
            % json.dumps(ink)
        )

    def test_springs_and_rigid_faces_are_drawn_and_counted(self) -> None:
        scene = {
            "body": {"rectangle": {"x": {"points": [0, 10], "divisions": [10]}, "y": {"points": [0, 2], "divisions": [2]}}},
            "material": {"young": 2.1e11, "poisson": 0.3},
            "supports": [{"on": {"boundary": "left"}, "x": 0}],
            "springs": [{"on": {"boundary": "bottom"}, "y": 1e6}],
            "rigid-faces": [{"boundary": "right", "force": [0, 5]}],
            "obstacles": [{"boundary": "top", "approach": "+y", "shape": {"plane": {"point": [0, 2], "normal": [0, 1]}}}],
        }
        for springs, faces in ((True, True), (False, True), (True, False)):
            kept = dict(scene)
            if not springs:
                kept.pop("springs")
                kept["supports"] = [{"on": {"boundary": "left"}, "x": 0, "y": 0}]
            if not faces:
                kept.pop("rigid-faces")
            path = self.folder / f"held-{springs}-{faces}.json"
            path.write_text(json.dumps(kept))
            page, _ = self.page("solve", path)
            self.opened(page)
            self.browser.frame()
            text = self.browser.ask("document.querySelector('#question').innerText")
            self.assertEqual("at 11 nodes of the boundary" in text, springs)
            self.assertEqual("3 nodes that move as one body" in text, faces)
            self.assertEqual(self.pixels("spring") > 100, springs)
            self.assertEqual(self.pixels("rigid") > 20, faces)

    def test_a_body_in_space_is_shown_from_the_side_of_its_obstacle(self) -> None:
        page, _ = self.page("solve", EXAMPLES / "ball.json")
        self.opened(page)
        self.assertGreater(self.browser.ask("View.all.at(-1).axes[2][2]"), 0.4)
        below = json.loads((EXAMPLES / "ball.json").read_text())
        below["obstacles"] = [{"boundary": "bottom", "approach": "-z", "shape": {"plane": {"point": [0, 0, 0], "normal": [0, 0, -1]}}}]
        below["supports"] = [{"on": {"boundary": "top"}, "x": 0, "y": 0, "z": -1e-3}]
        path = self.folder / "below.json"
        path.write_text(json.dumps(below))
        page, _ = self.page("solve", path)
        self.opened(page)
        self.assertLess(self.browser.ask("View.all.at(-1).axes[2][2]"), -0.4)


class TotalErrors(Pages):
    def test_a_guaranteed_error_is_shown_with_its_meshes(self) -> None:
        page, report = self.page("solve", ROOT / "studies/guarantee/coarse.json", "--total-error", "0.1")
        browser = self.opened(page)
        self.assertGreater(len(report["levels"]), 2)
        self.assertEqual(browser.ask("document.querySelectorAll('#levels tbody tr').length"), len(report["levels"]))
        bound = f"{100 * report['total_error']['bound']:.3g} %"
        self.assertIn(f"guaranteed at most {bound}", self.text("#levels"))
        points = browser.ask("document.querySelectorAll('#levels circle[tabindex]').length")
        # Displacement and mean stress on each mesh, and the force where an interval is known.
        forces = sum(level.get("force_interval") is not None for level in report["levels"])
        self.assertEqual(points, 2 * len(report["levels"]) + forces)
        self.assertGreater(browser.ask("document.querySelector('#levels #still img').naturalWidth"), 300)


class Sweeps(Pages):
    GAPS = "-0.01:-0.10:4"

    def test_every_position_of_the_slider_shows_the_exact_answer(self) -> None:
        scene = json.loads((EXAMPLES / "indentation.json").read_text())
        page, report = self.page("sweep", EXAMPLES / "indentation.json", "--gaps=" + self.GAPS)
        browser = self.opened(page)
        self.assertGreater(len(report["corners"]), 4)
        for point in report["points"]:
            force = browser.ask(f"exactFrame(signorini.data, {point['gap']!r}).facts.force")
            self.assertAlmostEqual(force / point["contact"]["force"], 1.0, delta=1e-11)
        # Between the gaps of the sweep, the page agrees with a separate solve.
        for gap in (-0.01234567, -0.0471, -0.0913579):
            path = self.folder / "between.json"
            path.write_text(json.dumps({**scene, "gap": gap}))
            solved = run("solve", path)
            facts = browser.ask(f"exactFrame(signorini.data, {gap!r}).facts")
            self.assertEqual(facts["count"], solved["contact"]["count"])
            for name in ("force", "pressure_max", "width"):
                self.assertAlmostEqual(facts[name] / solved["contact"][name], 1.0, delta=1e-10, msg=name)

    def test_the_slider_moves_the_body_and_its_numbers(self) -> None:
        page, _ = self.page("sweep", EXAMPLES / "indentation.json", "--gaps=" + self.GAPS)
        browser = self.opened(page)
        words, picture = self.text("#facts"), self.drawn("#answer .view")
        self.slide("#answer .slider input[type=range]", 0.73)
        self.assertNotEqual(self.text("#facts"), words)
        self.assertNotEqual(self.drawn("#answer .view"), picture)
        browser.ask("[...document.querySelectorAll('button')].find(b => b.textContent === 'next event').click()")
        gap = browser.ask("document.querySelector('#answer input[type=number]').valueAsNumber")
        self.assertIn(gap, browser.ask("signorini.data.sweep.events.map(event => event.gap)"))
        self.assertEqual(browser.faults(), [])


class Motions(Pages):
    def test_the_time_slider_moves_the_body_and_the_energies(self) -> None:
        page, report = self.page("solve", ROOT / "studies/impact/bouncing_bar.json")
        browser = self.opened(page)
        words, picture = self.text("#facts"), self.drawn("#answer .view")
        last = browser.ask("Number(document.querySelector('#answer .slider input').max)")
        self.assertGreater(last, 3)
        # It opens at the largest force.
        self.assertGreater(browser.ask("Number(document.querySelector('#answer .slider input').value)"), 0)
        self.slide("#answer .slider input[type=range]", 0)
        self.assertNotEqual(self.text("#facts"), words)
        self.assertNotEqual(self.drawn("#answer .view"), picture)
        total = browser.ask("signorini.data.motion.history.at(-2)")
        self.assertAlmostEqual(total / report["energy"]["last"]["total"], 1.0, delta=1e-12)
        self.assertEqual(browser.faults(), [])


class Tradeoffs(Pages):
    def test_a_point_of_a_trade_off_shows_its_values(self) -> None:
        page, report = self.page("tradeoff", EXAMPLES / "bar.json", "--runs", "1", "--refinements", "0")
        browser = self.opened(page)
        count = browser.ask("document.querySelectorAll('#tradeoff circle[tabindex]').length")
        self.assertEqual(count, len(report["points"]))
        browser.ask("document.querySelector('#tradeoff circle[tabindex]').focus()")
        self.assertIn(" s\nenergy error ", self.text("#tradeoff .tip"))
        # The pictures that the command draws.
        self.assertGreater(browser.ask("document.querySelector('#tradeoff #still img').naturalWidth"), 300)
        self.assertEqual(browser.faults(), [])


if __name__ == "__main__":
    unittest.main()
