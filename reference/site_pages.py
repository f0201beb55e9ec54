"""Tests the site of the documents in a real browser: `python -m unittest reference/site_pages.py`, after `reference/book.sh`.

Every page must open from files without an error and without a network request, show its formulas as formulas, and be no wider than a phone.
The search must find a word in a page.
"""

import os
import time
import unittest
from pathlib import Path

from browser import Browser

ROOT = Path(__file__).resolve().parent.parent
SITE = Path(os.environ.get("CARGO_TARGET_DIR", ROOT / "target")) / "book/site"
SCREEN, PHONE = (1280, 900), (390, 844)
PATIENCE = 20.0


class Site(unittest.TestCase):
    def setUp(self) -> None:
        self.browser = Browser()
        self.addCleanup(self.browser.close)

    def wait(self, expression: str) -> None:
        began = time.monotonic()
        while not self.browser.ask(expression):
            self.assertLess(time.monotonic() - began, PATIENCE, expression)
            time.sleep(0.02)

    def test_every_page_opens_without_an_error_and_fits_a_phone(self) -> None:
        pages = sorted(page for page in SITE.rglob("*.html") if page.name not in ("404.html", "toc.html"))
        self.assertGreater(len(pages), 35)
        formulas = 0
        for page in pages:
            self.browser.open(page, PHONE, ready="document.readyState === 'complete' && !!document.querySelector('main')")
            name = page.relative_to(SITE)
            self.assertEqual(self.browser.faults(), [], name)
            width = self.browser.ask("document.documentElement.scrollWidth")
            self.assertLessEqual(width, PHONE[0], f"{name} is wider than a phone")
            # A formula that the browser draws has a size.
            sizes = self.browser.ask("[...document.querySelectorAll('math')].map(f => f.getBoundingClientRect().width)")
            self.assertTrue(all(size > 0 for size in sizes), name)
            formulas += len(sizes)
            self.assertTrue(self.browser.ask("[...document.images].every(image => image.naturalWidth > 0)"), f"{name} lacks a picture")
        self.assertGreater(formulas, 300)

    def test_the_search_finds_a_word_without_network(self) -> None:
        self.browser.open(SITE / "index.html", SCREEN, ready="document.readyState === 'complete'")
        self.browser.ask("document.getElementById('mdbook-search-toggle').click()")
        self.browser.ask(
            "(() => { const bar = document.getElementById('mdbook-searchbar'); bar.value = 'complementarity';"
            " bar.dispatchEvent(new Event('input')); bar.dispatchEvent(new KeyboardEvent('keyup', {key: 'y'})); })()"
        )
        self.wait("document.querySelectorAll('#mdbook-searchresults li').length > 0")
        self.assertEqual(self.browser.faults(), [])


if __name__ == "__main__":
    unittest.main()
