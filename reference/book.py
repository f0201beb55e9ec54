"""Builds the documents as a site that opens without network: `python reference/book.py [--mdbook PROGRAM] [--out FOLDER]`.

The site has the pages that `docs/README.md` lists, in its order, with a search. Formulas become MathML, which every browser draws without
a script. A formula that cannot be converted, a link that leads nowhere and a heading that does not exist end the build with exit code 1.
"""

import argparse
import re
import shutil
import subprocess
import sys
from html.parser import HTMLParser
from pathlib import Path
from urllib.parse import unquote

from latex2mathml.converter import convert

ROOT = Path(__file__).resolve().parent.parent
FOR_DEVELOPERS = ("ARCHITECTURE.md", "CONTRIBUTING.md", "CHANGELOG.md", "reference/README.md", "distributed/README.md", "python/README.md")

LINK = re.compile(r"(\[(?:[^\[\]]|\[[^\]]*\])*\]\()([^)\s#]*)(#[^)\s]*)?\)")
ROW = re.compile(r"^\| \[(.+?)\]\((.+?\.md)\)")
FENCED = re.compile(r"^(```+).*?^\1[ ]*$", re.MULTILINE | re.DOTALL)
VERBATIM = re.compile(FENCED.pattern + r"|`[^`]+`", re.MULTILINE | re.DOTALL)
DISPLAY = re.compile(r"^( *)```math\n(.*?)^ *```[ ]*$", re.MULTILINE | re.DOTALL)
INLINE = re.compile(r"(?<![\\$\w])\$(?=[^\s$])([^$\n]*(?:\n(?!\n)[^$\n]*)*?)(?<=[^\s\\])\$(?![\w$])")
"""A formula begins and ends at a dollar sign with a letter beside it on its inner side, and may continue on the next line."""


class Fault(Exception):
    """A document is wrong; the message says where."""


def summary() -> str:
    """The table of contents: the pages of each section of docs/README.md, then those for developers."""
    lines = ["# Summary", "", "[signorini](README.md)", "[Documents](docs/README.md)"]
    heading = ""
    for line in (ROOT / "docs/README.md").read_text().splitlines():
        if line.startswith("## "):
            heading = line[3:]
        elif row := ROW.match(line):
            if heading:
                lines += ["", f"# {heading}", ""]
            heading = ""
            lines.append(f"- [{row[1]}](docs/{row[2]})")
    lines += ["", "# For developers", ""]
    for name in FOR_DEVELOPERS:
        title = (ROOT / name).read_text().split("\n", 1)[0].lstrip("# ")
        lines.append(f"- [{title}]({name})")
    return "\n".join(lines) + "\n"


def pages_of(contents: str) -> list[str]:
    return re.findall(r"\]\((.+?\.md)\)", contents)


def formula(page: str, text: str, display: str) -> str:
    try:
        return convert(" ".join(text.split()), display=display)
    except Exception as error:
        raise Fault(f"{page}: the formula {text!r} cannot be converted: {error!r}") from error


def outside(pattern: re.Pattern, change, text: str) -> str:
    """Applies a change to the text between the parts that a pattern finds."""
    parts, end = [], 0
    for found in pattern.finditer(text):
        parts += [change(text[end : found.start()]), found[0]]
        end = found.end()
    return "".join(parts) + change(text[end:])


def with_formulas(page: str, text: str) -> str:
    text = DISPLAY.sub(lambda found: found[1] + formula(page, found[2], "block"), text)
    return outside(VERBATIM, lambda part: INLINE.sub(lambda found: formula(page, found[1], "inline"), part), text)


def stage(folder: Path, contents: str) -> None:
    """Writes the pages of the site, and copies the files that they show or link to."""
    pages = set(pages_of(contents))
    for name in pages:
        page = ROOT / name
        text = with_formulas(name, page.read_text())

        def link(found: re.Match, page: Path = page, name: str = name) -> str:
            target, heading = found[2], found[3] or ""
            if not target or "://" in target:
                return found[0]
            file = (page.parent / target).resolve()
            if not file.is_relative_to(ROOT) or not file.exists():
                raise Fault(f"{name} links to {target}, which does not exist")
            place = file.relative_to(ROOT)
            if str(place) not in pages:
                if file.is_dir():
                    raise Fault(f"{name} links to the folder {target}; a page can show a file only")
                (folder / place).parent.mkdir(parents=True, exist_ok=True)
                shutil.copyfile(file, folder / place)
            elif file.name == "README.md":
                target = target.removesuffix("README.md") + "index.md"
            return f"{found[1]}{target}{heading})"

        text = outside(FENCED, lambda part, link=link: LINK.sub(link, part), text)
        target = folder / name.replace("README.md", "index.md")
        target.parent.mkdir(parents=True, exist_ok=True)
        target.write_text(text)
    (folder / "SUMMARY.md").write_text(contents.replace("README.md", "index.md"))


class Page(HTMLParser):
    """The links and names of a page, and its text outside of code."""

    def __init__(self, file: Path) -> None:
        super().__init__()
        self.links, self.names, self.prose, self.formulas, self.inside = [], set(), [], 0, []
        self.feed(file.read_text())

    def handle_starttag(self, tag: str, attributes: list[tuple[str, str | None]]) -> None:
        values = dict(attributes)
        self.links += [value for key in ("href", "src") if (value := values.get(key))]
        self.names |= {value for key in ("id", "name") if (value := values.get(key))}
        self.formulas += tag == "math"
        if tag in ("code", "script", "style", "math"):
            self.inside.append(tag)

    def handle_endtag(self, tag: str) -> None:
        if self.inside and self.inside[-1] == tag:
            self.inside.pop()

    def handle_data(self, data: str) -> None:
        if not self.inside:
            self.prose.append(data)


def faults_of(site: Path) -> tuple[list[str], int, int]:
    """All dead links and formulas that are still text; the number of links and of formulas."""
    pages = {file: Page(file) for file in sorted(site.rglob("*.html")) if file.name != "404.html"}
    faults, links = [], 0
    for file, page in pages.items():
        name = file.relative_to(site)
        for link in page.links:
            path, _, heading = unquote(link).partition("#")
            if "://" in path or path.startswith(("data:", "mailto:")):
                continue
            links += 1
            target = (file.parent / path).resolve() if path else file
            if not target.is_file():
                faults.append(f"{name} links to {link}, which is not there")
            elif heading and target in pages and heading not in pages[target].names:
                faults.append(f"{name} links to {link}, where no such heading is")
        if "$" in "".join(page.prose):
            faults.append(f"{name} shows a dollar sign: a formula is still text")
    return faults, links, sum(page.formulas for page in pages.values())


def main() -> int:
    parser = argparse.ArgumentParser(description=(__doc__ or "").split("\n\n")[0])
    parser.add_argument("--mdbook", default=str(ROOT / "target/mdbook/bin/mdbook"))
    parser.add_argument("--out", type=Path, default=ROOT / "target/book")
    options = parser.parse_args()
    source = options.out / "source"
    shutil.rmtree(options.out, ignore_errors=True)
    source.mkdir(parents=True)
    try:
        contents = summary()
        stage(source, contents)
    except Fault as fault:
        print(fault, file=sys.stderr)
        return 1
    (options.out / "book.toml").write_text((ROOT / "docs/book.toml").read_text().replace("[book]", '[book]\nsrc = "source"', 1))
    subprocess.run([options.mdbook, "build", "--dest-dir", str(options.out.resolve() / "site"), str(options.out)], check=True)
    faults, links, formulas = faults_of(options.out / "site")
    for fault in faults:
        print(fault, file=sys.stderr)
    print(f"{options.out / 'site/index.html'}: {len(pages_of(contents))} pages, {links} links, {formulas} formulas, {len(faults)} faults")
    return int(bool(faults))


if __name__ == "__main__":
    sys.exit(main())
