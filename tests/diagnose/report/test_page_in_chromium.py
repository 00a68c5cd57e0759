# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""report.html in headless Chromium: whole, without errors, on two widths."""

import html
import json
import re
import shutil
import subprocess

import pytest

from cg2raw.diagnose.report import write_report
from diagnose.made_up_diagnosis import made_up_diagnosis, pictures

pytestmark = pytest.mark.slow
WIDTHS = (1280, 400)
LEAST_TYPE = 11  # CSS pixels
# A frame of exactly that width, whatever the least width of a browser's window is.
WRAPPER = """<!DOCTYPE html><body style="margin:0">
<iframe id="page" src="{page}" style="border:0;width:{width}px;height:900px"></iframe>
<pre id="seen"></pre>
<script>
document.getElementById("page").onload = (event) => {{
  const inner = event.target.contentDocument;
  inner.querySelectorAll("details").forEach((each) => {{ each.open = {opened}; }});
  const root = inner.documentElement;
  const images = [...inner.images];
  const texts = [...inner.querySelectorAll("body *")].filter(
    (each) => [...each.childNodes].some((n) => n.nodeType === 3 && n.data.trim()));
  const style = (each) => event.target.contentWindow.getComputedStyle(each);
  const wide = [...inner.querySelectorAll("body *")].filter(
    (each) => each.getBoundingClientRect().right > root.clientWidth + 0.5
      && !each.closest(".wide"));
  document.getElementById("seen").textContent = JSON.stringify({{
    images: images.length,
    broken: images.filter((i) => !i.complete || !i.naturalWidth).map((i) => i.alt),
    hidden: images.filter((i) => i.clientWidth < 80).map((i) => i.alt),
    charts: inner.querySelectorAll("svg").length,
    collisions: [...inner.querySelectorAll("svg")].flatMap((chart) => {{
      const boxes = [...chart.querySelectorAll("text")].map(
        (each) => [each.textContent, each.getBoundingClientRect()]);
      const [left, right] = [chart.getBoundingClientRect().left - 1,
                             chart.getBoundingClientRect().right + 1];
      return boxes.flatMap(([words, a], n) => [
        ...boxes.slice(n + 1).filter(([_, b]) => a.width && b.width
          && a.left < b.right && b.left < a.right
          && a.top + 2 < b.bottom && b.top + 2 < a.bottom)
          .map(([other]) => `${{words}} on ${{other}}`),
        ...(a.left < left || a.right > right ? [`${{words}} outside`] : [])]);
    }}),
    width: root.clientWidth,
    scroll: root.scrollWidth,
    wide: wide.map((each) => each.outerHTML.slice(0, 80)),
    least_type: Math.min(...texts.map((each) => parseFloat(style(each).fontSize))),
  }});
}};
</script>"""
BROKEN = """<!DOCTYPE html><body><div style="width:2000px">wide</div>
<p style="font-size:5px">small</p><img alt="broken" src="data:image/png;base64,AAAA">
<svg viewBox="0 0 100 50" width="100"><text x="9" y="20">one</text>
<text x="12" y="20">two</text><text x="90" y="45">far</text></svg>
<script>undefined_function();</script>"""


@pytest.fixture(scope="module")
def chromium():
    names = ("chromium", "chromium-browser", "google-chrome")
    for name in names:
        if shutil.which(name):
            return shutil.which(name)
    pytest.skip("no Chromium: apt-get install chromium")


@pytest.fixture(scope="module")
def report(tmp_path_factory):
    folder = tmp_path_factory.mktemp("report")
    long_name = "a_frame_with_a_name_that_has_no_space_to_break_at_" * 3 + ".dng"
    diagnosis = made_up_diagnosis(pictures=pictures(4, 220, 330), interrupted=True)
    diagnosis.groups["fit"].append(long_name)
    write_report(diagnosis, folder)
    return folder / "report.html"


def look(chromium, page, width, folder, opened=True):
    """Return what a screen of that width shows of @page, and the console's errors."""
    wrapper = folder / "wrapper.html"
    wrapper.write_text(
        WRAPPER.format(page=page.as_uri(), width=width, opened=json.dumps(opened))
    )
    done = subprocess.run(
        [
            chromium, "--headless", "--no-sandbox", "--disable-gpu",
            "--allow-file-access-from-files", f"--user-data-dir={folder / 'profile'}",
            "--window-size=1400,1000", "--virtual-time-budget=20000",
            "--enable-logging=stderr", "--v=0", "--dump-dom", wrapper.as_uri(),
        ],
        capture_output=True, text=True, timeout=180, check=True,
    )  # fmt: skip
    seen = re.search(r'<pre id="seen">(.+?)</pre>', done.stdout, re.S)
    assert seen, done.stderr
    errors = [line for line in done.stderr.splitlines() if "CONSOLE" in line]
    return json.loads(html.unescape(seen[1])), errors


@pytest.mark.parametrize("opened", [False, True], ids=["closed", "opened"])
@pytest.mark.parametrize("width", WIDTHS)
def test_the_report_is_drawn_and_fits(chromium, report, width, opened, tmp_path):
    seen, errors = look(chromium, report, width, tmp_path, opened)
    assert errors == []
    assert seen["images"] == 4 * 3 and seen["charts"] >= 6
    assert seen["broken"] == [] and (seen["hidden"] == [] or not opened)
    assert seen["collisions"] == []
    assert seen["scroll"] <= seen["width"] <= width and seen["wide"] == []
    assert seen["least_type"] >= LEAST_TYPE


def test_a_broken_page_is_noticed(chromium, tmp_path):
    page = tmp_path / "broken.html"
    page.write_text(BROKEN)
    seen, errors = look(chromium, page, 400, tmp_path)
    assert len(errors) == 1 and "undefined_function" in errors[0]
    assert seen["broken"] == ["broken"] and seen["hidden"] == ["broken"]
    assert "one on two" in seen["collisions"] and "far outside" in seen["collisions"]
    assert seen["scroll"] >= 2000 and seen["wide"] and seen["least_type"] == 5
