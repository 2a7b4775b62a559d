"""Opens a report in a headless Chromium and fails on anything a reader would stumble over.

    python3 tests/render/browser.py runs/habe/report.html [--screenshots DIR] [--chromium PATH]

Needs Chromium (Debian: apt-get install chromium) and nothing else. A probe is put into a copy of the page:
it clicks a heading to sort and tells a frame around the page what it saw, which Chromium prints. Checked at
desktop and phone width: no message on the console, no request, no violation of the content security policy,
the verdict in sight without scrolling, every figure drawn inside the page, no page wider than the window,
tables that sort, and text with a contrast of at least 4.5 on a light page.
"""

import argparse
import html
import json
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile

FLAGS = [
    "--headless", "--no-sandbox", "--disable-gpu", "--disable-quic", "--no-first-run",
    "--disable-background-networking", "--disable-component-update", "--disable-sync",
    "--hide-scrollbars", "--enable-logging=stderr",
]

PROBE = r"""
<script>
addEventListener("load", () => {
  const box = (e) => e.getBoundingClientRect();
  const figures = [...document.querySelectorAll("figure svg")].map((svg) => {
    const frame = box(svg);
    const spilled = [...svg.querySelectorAll("text")].filter((t) => {
      const b = box(t);
      return b.left < frame.left - 1 || b.right > frame.right + 1 || b.top < frame.top - 1 ||
        b.bottom > frame.bottom + 1;
    }).map((t) => t.textContent);
    const labels = [...svg.querySelectorAll("text")].filter((t) => t.textContent);
    const overlaps = [];
    labels.forEach((a, i) => labels.slice(i + 1).forEach((b) => {
      const [p, q] = [box(a), box(b)];
      const wide = Math.min(p.right, q.right) - Math.max(p.left, q.left);
      const high = Math.min(p.bottom, q.bottom) - Math.max(p.top, q.top);
      if (wide > 1 && high > 0.35 * Math.min(p.height, q.height)) {
        overlaps.push(a.textContent + " | " + b.textContent);
      }
    }));
    return { name: svg.querySelector("title").textContent, width: frame.width, height: frame.height,
      left: frame.left, right: frame.right, spilled, overlaps };
  });
  const light = (css) => {
    const c = css.match(/[\d.]+/g).slice(0, 3).map((v) => v / 255)
      .map((v) => (v <= 0.04045 ? v / 12.92 : ((v + 0.055) / 1.055) ** 2.4));
    return 0.2126 * c[0] + 0.7152 * c[1] + 0.0722 * c[2];
  };
  const ground = (e) => {
    for (; e; e = e.parentElement) {
      const c = getComputedStyle(e).backgroundColor;
      if (c !== "rgba(0, 0, 0, 0)") return c;
    }
    return "rgb(255, 255, 255)";
  };
  const faint = [...document.querySelectorAll("p, li, td, th, a, h1, h2, h3, figcaption, dt, dd, button, summary")]
    .filter((e) => {
      const [a, b] = [light(getComputedStyle(e).color), light(ground(e))].sort((x, y) => y - x);
      return (a + 0.05) / (b + 0.05) < 4.5;
    }).map((e) => e.textContent.slice(0, 40));
  const table = document.querySelector("table.sortable");
  const column = Math.min(2, table.tHead.rows[0].cells.length - 1);
  const first = () => [...table.tBodies[0].rows].map((r) => r.cells[column].textContent);
  const button = table.querySelectorAll("thead button")[column];
  button.click();
  const ascending = first();
  button.click();
  const descending = first();
  const seen = {
    figures, faint, ascending, descending,
    sorted: table.querySelectorAll("thead th")[column].getAttribute("aria-sort"),
    verdict_top: box(document.querySelector("#verdict")).top,
    width: document.documentElement.scrollWidth, window: innerWidth, height: innerHeight,
    requests: performance.getEntriesByType("resource").map((r) => r.name),
  };
  parent.postMessage(JSON.stringify(seen), "*");
});
</script>
"""

# A headless window is never narrower than 500 pixels, a frame is.
FRAME = """<!DOCTYPE html><body style="margin:0"><iframe src="report.html" width="{width}" height="{height}"
style="border:0"></iframe><script>addEventListener("message", (event) => {{
  const out = document.createElement("pre");
  out.id = "probe";
  out.textContent = event.data;
  document.body.append(out);
}});</script></body>"""


def chromium(program, page, extra):
    with tempfile.TemporaryDirectory() as profile:
        command = [program, *FLAGS, f"--user-data-dir={profile}", *extra, page.as_uri()]
        return subprocess.run(command, capture_output=True, text=True, timeout=120)


def framed(program, text, width, height, extra):
    """Runs Chromium on a report in a frame of this size."""
    with tempfile.TemporaryDirectory() as directory:
        frame = pathlib.Path(directory) / "frame.html"
        frame.write_text(FRAME.format(width=width, height=height), encoding="utf-8")
        (frame.parent / "report.html").write_text(text, encoding="utf-8")
        return chromium(program, frame, [f"--window-size={max(width, 500)},{height}", *extra])


def look(program, text, width, height):
    """What is wrong with a report at one size of its window."""
    wrong = []
    done = framed(program, text.replace("</body>", PROBE + "</body>"), width, height, ["--dump-dom"])
    for line in done.stderr.splitlines():
        if "CONSOLE" in line:
            wrong.append(f"console: {line}")
    match = re.search(r'<pre id="probe">(.*?)</pre>', done.stdout, re.S)
    if not match:
        return wrong + [f"the probe did not run: {done.stderr[-500:]}"]
    seen = json.loads(html.unescape(match.group(1)))
    wanted = text.count("<figure>")
    if len(seen["figures"]) != wanted:
        wrong.append(f"{len(seen['figures'])} figures drawn of {wanted}")
    for figure in seen["figures"]:
        if figure["width"] < 200 or figure["height"] < 100:
            wrong.append(f"figure too small: {figure}")
        if figure["left"] < 0 or figure["right"] > seen["window"] + 1:
            wrong.append(f"figure leaves the page: {figure}")
        if figure["spilled"]:
            wrong.append(f"text leaves the figure {figure['name']}: {figure['spilled']}")
        if figure["overlaps"]:
            wrong.append(f"text over text in {figure['name']}: {figure['overlaps']}")
    if seen["width"] > seen["window"]:
        wrong.append(f"the page is {seen['width']} wide in a window of {seen['window']}")
    if seen["verdict_top"] > seen["height"]:
        wrong.append("the verdict is not in sight")
    if seen["requests"]:
        wrong.append(f"requests: {seen['requests']}")
    if seen["faint"]:
        wrong.append(f"contrast below 4.5: {seen['faint'][:5]}")
    share = lambda t: 0.01 * float(t[:-1]) if t.endswith("%") else float(t)
    try:
        values = [share(t) for t in seen["descending"] if t != "–"]
    except ValueError:  # words
        values = []
    if values != sorted(values, reverse=True) or seen["sorted"] != "descending":
        wrong.append(f"the table did not sort: {seen['descending']}")
    return wrong


def main():
    arguments = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    arguments.add_argument("report", type=pathlib.Path)
    arguments.add_argument("--screenshots", type=pathlib.Path)
    arguments.add_argument("--chromium", default=shutil.which("chromium") or shutil.which("google-chrome"))
    given = arguments.parse_args()
    if not given.chromium:
        sys.exit("no Chromium found: name one with --chromium")
    wrong = []
    text = given.report.read_text(encoding="utf-8")
    for name, width, height, whole in [("desktop", 1280, 900, 9000), ("phone", 390, 800, 16000)]:
        wrong += [f"{name}: {line}" for line in look(given.chromium, text, width, height)]
        if given.screenshots:
            given.screenshots.mkdir(parents=True, exist_ok=True)
            picture = given.screenshots.resolve() / f"report-{name}.png"
            framed(given.chromium, text, width, whole, [f"--screenshot={picture}"])
    print("\n".join(wrong) or "nothing wrong")
    sys.exit(bool(wrong))


if __name__ == "__main__":
    main()
