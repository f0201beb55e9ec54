"""Validates scenes by the package jsonschema with the JSON Schema that the program prints.

Every scene of the project must conform. Every scene of `tests/wrong_scenes.json` must be refused by the schema and by the program.

    python reference/schema.py target/debug/signorini
"""

import copy
import json
import pathlib
import subprocess
import sys
import tempfile

from jsonschema import Draft202012Validator

ROOT = pathlib.Path(__file__).resolve().parent.parent


def scenes():
    """Returns all scenes of the project. Lines that begin with `//` are comments and are removed, because JSON has no comments."""
    for folder in ["examples", "examples/first-part", "examples/two-parts", "studies/guarantee", "studies/impact"]:
        for file in sorted((ROOT / folder).glob("*.json")):
            lines = file.read_text().splitlines()
            yield file, json.loads("\n".join(line for line in lines if not line.lstrip().startswith("//")))


def wrong_scenes():
    """Returns the fault and the scene for each entry; a scene is the base with one change."""
    kept = json.loads((ROOT / "tests/wrong_scenes.json").read_text())
    for change in kept["changes"]:
        scene = copy.deepcopy(kept["base"])
        *keys, last = change["at"].split("/")[1:]
        place = scene
        for key in keys:
            place = place[int(key) if isinstance(place, list) else key]
        if "value" in change:
            place[last] = change["value"]
        else:
            del place[last]
        yield change["wrong"], scene


def main(program):
    """Checks all scenes."""
    with tempfile.TemporaryDirectory() as folder:
        folder = pathlib.Path(folder)
        schema = json.loads(subprocess.run([program, "schema"], capture_output=True, check=True).stdout)
        Draft202012Validator.check_schema(schema)
        validator = Draft202012Validator(schema)
        file = folder / "scene.json"
        right = list(scenes())
        for name, scene in right:
            if not validator.is_valid(scene):
                sys.exit(f"the schema refuses {name}")
        wrong = list(wrong_scenes())
        for what, scene in wrong:
            if validator.is_valid(scene):
                sys.exit(f"the schema takes {what}")
            file.write_text(json.dumps(scene))
            code = subprocess.run([program, "solve", file], capture_output=True, check=False).returncode
            if code != 1:
                sys.exit(f"the program ends with {code} for {what}")
    if len(right) < 10 or len(wrong) < 20:
        sys.exit(f"{len(right)} scenes and {len(wrong)} wrong ones are too few")
    print(f"{len(right)} scenes conform, {len(wrong)} wrong ones are refused by the schema and by the program")


if __name__ == "__main__":
    main(pathlib.Path(sys.argv[1]).resolve())
