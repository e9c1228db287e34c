#!/usr/bin/python3
"""The page that `homolog report` writes, in a browser without a display: report_test.py PROGRAM [FOLDER].

Chromium draws it with software GL and is spoken to through pipes (the DevTools protocol). The page has to draw, to move vertices
to where the model has them, and to be silent: no error, no request. With FOLDER pictures of the page are left there. Exit
status 77: there is no Chromium.
"""

import base64
import json
import os
import pathlib
import select
import shutil
import subprocess
import sys
import tempfile
import time

program = pathlib.Path(sys.argv[1]).resolve()
pictures = pathlib.Path(sys.argv[2]) if len(sys.argv) > 2 else None
chromium = shutil.which("chromium")
if chromium is None:
    print("SKIPPED: no peer: chromium is not installed")
    sys.exit(77)

faults = []


def fault(what):
    faults.append(what)
    print("FAULT:", what)


def check(what, good):
    if not good:
        fault(what)


class Browser:
    """Chromium, spoken to through two pipes: its file descriptors 3 (commands) and 4 (answers), a 0 behind each message."""

    def __init__(self, profile):
        commands, self.to = os.pipe()
        self.answers, back = os.pipe()

        def as_three_and_four():
            high = [os.dup(commands), os.dup(back)]  # neither may be 3 or 4 when the other is put there
            os.dup2(high[0], 3)
            os.dup2(high[1], 4)

        self.process = subprocess.Popen(
            [chromium, "--headless", "--no-sandbox", "--use-gl=angle", "--use-angle=swiftshader", "--enable-unsafe-swiftshader",
             "--remote-debugging-pipe", f"--user-data-dir={profile}", "--hide-scrollbars", "--no-first-run",
             "--disable-background-networking", "about:blank"],
            preexec_fn=as_three_and_four, close_fds=False, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        os.close(commands)
        os.close(back)
        self.number, self.unread, self.events, self.session = 0, b"", [], None
        target = self.ask("Target.createTarget", url="about:blank")["targetId"]
        self.session = self.ask("Target.attachToTarget", targetId=target, flatten=True)["sessionId"]
        for domain in ("Page", "Runtime", "Log", "Network"):
            self.ask(f"{domain}.enable")

    def message(self, until):
        while b"\0" not in self.unread:
            left = until - time.monotonic()
            if left <= 0 or not select.select([self.answers], [], [], left)[0]:
                raise TimeoutError("the browser does not answer")
            some = os.read(self.answers, 1 << 20)
            if not some:
                raise EOFError("the browser ended")
            self.unread += some
        text, self.unread = self.unread.split(b"\0", 1)
        return json.loads(text)

    def ask(self, method, **parameters):
        self.number += 1
        request = {"id": self.number, "method": method, "params": parameters}
        if self.session:
            request["sessionId"] = self.session
        data = json.dumps(request).encode() + b"\0"
        while data:
            data = data[os.write(self.to, data):]
        until = time.monotonic() + 60
        while True:
            got = self.message(until)
            if got.get("id") == self.number:
                if "error" in got:
                    raise RuntimeError(f"{method}: {got['error']['message']}")
                return got["result"]
            self.events.append(got)

    def evaluate(self, expression):
        got = self.ask("Runtime.evaluate", expression=expression, returnByValue=True, awaitPromise=True)
        if "exceptionDetails" in got:
            raise RuntimeError(got["exceptionDetails"].get("exception", {}).get("description", "exception"))
        return got["result"].get("value")

    def open(self, page, width=1280, height=1000, features=()):
        self.ask("Emulation.setDeviceMetricsOverride", width=width, height=height, deviceScaleFactor=1, mobile=width < 600)
        self.ask("Emulation.setEmulatedMedia", media="", features=[{"name": name, "value": value} for name, value in features])
        self.events.clear()
        self.ask("Page.navigate", url=page.as_uri())
        for _ in range(300):
            if self.evaluate("document.readyState") == "complete":
                break
            time.sleep(0.1)
        self.frames()

    def frames(self, count=3):
        self.evaluate("(async () => { for (let k = 0; k < %d; ++k) await new Promise(requestAnimationFrame); })()" % count)

    def picture(self, name):
        if pictures is None:
            return
        size = self.ask("Page.getLayoutMetrics")["cssContentSize"]
        shot = self.ask("Page.captureScreenshot", captureBeyondViewport=True,
                        clip={"x": 0, "y": 0, "width": size["width"], "height": size["height"], "scale": 1})
        pictures.mkdir(exist_ok=True)
        (pictures / f"{name}.png").write_bytes(base64.b64decode(shot["data"]))

    def close(self):
        try:
            self.session = None
            self.ask("Browser.close")
            self.process.wait(20)
        except Exception:
            self.process.kill()
            self.process.wait()


def check_silent(browser, what):
    """No error, no warning of the page, no request but for the page itself."""
    for event in browser.events:
        method, values = event.get("method"), event.get("params", {})
        if method == "Runtime.exceptionThrown":
            fault(f"{what}: exception: {values['exceptionDetails'].get('exception', {}).get('description')}")
        if method == "Runtime.consoleAPICalled" and values["type"] in ("error", "warning", "assert"):
            fault(f"{what}: console: {[one.get('value') for one in values['args']]}")
        if method == "Log.entryAdded" and values["entry"]["level"] == "error":
            fault(f"{what}: log: {values['entry']['text']}")
        if method == "Network.requestWillBeSent" and not values["request"]["url"].startswith(("file:", "data:", "blob:")):
            fault(f"{what}: request of {values['request']['url']}")
        if method == "Network.requestWillBeSent" and values["request"]["url"].startswith("file:") and values["type"] != "Document":
            fault(f"{what}: request of {values['request']['url']}")


# How much of a canvas is drawn on, and how many colours there are.
drawn = """(() => {
  const from = document.querySelector(%s), to = document.createElement("canvas");
  to.width = from.width; to.height = from.height;
  const context = to.getContext("2d");
  context.drawImage(from, 0, 0);
  const pixels = new Uint32Array(context.getImageData(0, 0, to.width, to.height).data.buffer);
  let count = 0;
  const colours = new Set();
  for (const pixel of pixels) if (pixel >>> 24 > 128) ++count, colours.add(pixel);
  return [count / pixels.length, colours.size];
})()"""


def run(folder, *arguments):
    ran = subprocess.run([program, *map(str, arguments)], capture_output=True, text=True, cwd=folder)
    if ran.returncode != 0:
        sys.exit(f"{' '.join(map(str, arguments))}: {ran.stderr.strip()}")
    return ran.stdout


def points_of(folder, model, coefficients):
    """mean + sum of coefficient · √λ · axis, from the model's file."""
    text = json.loads((folder / model).read_text())
    values = {}

    def gather(group, path):
        for link in text["groups"][group].get("links", []):
            here = f"{path}/{link['title']}"
            if link["collection"] == "groups":
                gather(link["id"], here)
            else:
                values[here] = text["datasets"][link["id"]]["value"]

    gather(text["root"], "")
    mean, basis, variances = values["/model/mean"], values["/model/pcaBasis"], values["/model/pcaVariance"]
    return [mean[i] + sum(z * variances[m] ** 0.5 * basis[i][m] for m, z in enumerate(coefficients)) for i in range(len(mean))]


def move_sliders(browser, coefficients):
    for mode, value in enumerate(coefficients):
        browser.evaluate("(() => { const slider = document.querySelectorAll('#sliders input')[%d]; slider.value = %r;"
                         " slider.dispatchEvent(new Event('input')); })()" % (mode, value))
    browser.frames()


def drag(browser, mode, deviations):
    """Takes the thumb of a slider with the mouse and lets it go at so many standard deviations."""
    left, top, width, height, value = browser.evaluate(
        "(() => { const slider = document.querySelectorAll('#sliders input')[%d]; slider.scrollIntoView({ block: 'center' });"
        " const box = slider.getBoundingClientRect(); return [box.left, box.top, box.width, box.height, Number(slider.value)]; })()" % mode)
    thumb = height  # which the ends of the way keep inside: it is about as wide as the slider is high

    def at(deviations_there):
        return left + thumb / 2 + (width - thumb) * (deviations_there + 3) / 6

    def mouse(kind, x, buttons):
        browser.ask("Input.dispatchMouseEvent", type=kind, x=x, y=top + height / 2, button="left", buttons=buttons, clickCount=1)

    mouse("mousePressed", at(value), 1)
    for step in range(1, 6):
        mouse("mouseMoved", at(value + (deviations - value) * step / 5), 1)
    mouse("mouseReleased", at(deviations), 0)
    browser.frames()


def press(browser, key, times=1):
    code = {"ArrowRight": 39, "ArrowLeft": 37, "Home": 36, "End": 35, "Tab": 9}[key]
    for _ in range(times):
        for kind in ("keyDown", "keyUp"):
            browser.ask("Input.dispatchKeyEvent", type=kind, key=key, code=key, windowsVirtualKeyCode=code)
    browser.frames()


def check_moved_by_hand(browser, folder):
    """The sliders as a person moves them, with the mouse and with keys alone."""

    def check_place(what, wanted):
        values = browser.evaluate("[...document.querySelectorAll('#sliders input')].map(slider => Number(slider.value))")
        check(f"{what}: the first two sliders stand at {wanted}, not {values[:2]}",
              all(abs(value - aim) < 0.11 for value, aim in zip(values, wanted)))
        said = browser.evaluate("[...document.querySelectorAll('#sliders output')].map(one => one.textContent.replace('\\u2212', '-'))")
        check(f"{what}: what stands beside them, {said}, is where they stand",
              all(abs(float(text) - value) < 0.051 for text, value in zip(said, values)))
        shown = browser.evaluate("homologReport.positions()")
        off = max(abs(a - b) for a, b in zip(shown, points_of(folder, "m.h5.json", values)))
        print(f"{what}: vertices within {off:.2g} mm of the model")
        check(f"{what}: vertices are where the model has them", off < 1e-3)

    move_sliders(browser, [0, 0])
    drag(browser, 0, 1.5)
    check_place("the first slider dragged", [1.5, 0])
    drag(browser, 1, -2)
    check_place("then the second", [1.5, -2])
    drag(browser, 0, 9)
    check_place("the first beyond its end", [3, -2])
    browser.evaluate("document.querySelectorAll('#sliders input')[1].focus()")
    press(browser, "Home")
    check_place("the second by Home", [3, -3])
    press(browser, "ArrowRight", 4)
    check_place("and four steps on", [3, -2.8])
    browser.evaluate("document.querySelectorAll('.point')[1].dispatchEvent(new MouseEvent('click'))")
    press(browser, "End")
    check_place("a key while a case is shown", [0, 3])
    check("the case is left then", "p2" not in browser.evaluate("document.getElementById('shown').textContent"))
    move_sliders(browser, [0, 0])


def check_page(browser, folder):
    page = folder / "page.html"
    browser.open(page)
    check("the shape is drawn", 0.05 < browser.evaluate(drawn % "'#view'")[0] < 0.9)
    check("it is drawn in many colours", browser.evaluate(drawn % "'#view'")[1] > 200)
    share, colours = browser.evaluate(drawn % "'#gallery canvas'")
    check("the gallery is drawn", 0.05 < share < 0.9 and colours > 200)
    check("each case has a cell", browser.evaluate("document.querySelectorAll('.cell').length") == 6)
    browser.picture("light")
    for coefficients in ([0, 0], [2.5, 0], [-3, 1.25]):
        move_sliders(browser, coefficients)
        shown = browser.evaluate("homologReport.positions()")
        wanted = points_of(folder, "m.h5.json", coefficients)
        check(f"{coefficients} has all vertices", len(shown) == len(wanted))
        off = max(abs(a - b) for a, b in zip(shown, wanted))
        print(f"sliders at {coefficients}: vertices within {off:.2g} mm of the model")
        check(f"sliders at {coefficients} move vertices to where the model has them", off < 1e-3)
    check_moved_by_hand(browser, folder)
    browser.evaluate("document.querySelectorAll('.slider button')[0].click()")
    before = browser.evaluate("homologReport.positions()")
    browser.frames(20)
    check("the first mode plays", before != browser.evaluate("homologReport.positions()"))
    browser.evaluate("document.querySelectorAll('.slider button')[0].click()")
    check("each measurement has a plot and a row a mode", browser.evaluate(
        "[document.querySelectorAll('#measurements figure').length, document.querySelectorAll('#measurements + .table tbody tr').length]") == [2, 6])
    browser.evaluate("document.querySelector('#measurements svg').dispatchEvent(new KeyboardEvent('keydown', { key: 'ArrowRight' }))")
    row = browser.evaluate("[...document.querySelector('#measurements + .table tbody tr').cells].map(cell => cell.textContent)")
    said = browser.evaluate("document.querySelector('#measurements .readout').textContent")
    check("a plot says what the table says", said.startswith("At +1 SD: mode 1 " + row[6]) and row[6] not in row[:6])
    for colouring in ("moved", "doubt", "groups"):
        browser.evaluate(f"document.querySelector('[data-colouring={colouring}]').click()")
        browser.frames()
        check(f"the colouring {colouring} has a legend", not browser.evaluate("document.getElementById('legend').hidden"))
    browser.evaluate("document.querySelectorAll('#cases tbody tr')[2].dispatchEvent(new Event('pointerenter'))")
    check("pointing at a row lights its cell and its point", browser.evaluate(
        "document.querySelectorAll('.cell')[2].classList.contains('on') && document.querySelectorAll('.point')[2].classList.contains('on')"))
    browser.evaluate("document.querySelectorAll('.point')[1].dispatchEvent(new MouseEvent('click'))")
    browser.frames()
    check("a click on a point shows the case", "p2" in browser.evaluate("document.getElementById('shown').textContent"))
    check_silent(browser, "the page")
    browser.picture("case")
    browser.open(page, features=[("prefers-color-scheme", "dark")])
    check("dark grounds are dark", browser.evaluate("getComputedStyle(document.documentElement).backgroundColor") == "rgb(14, 15, 17)")
    browser.picture("dark")
    browser.open(page, width=390, height=800)
    check("nothing is wider than a phone", browser.evaluate("document.documentElement.scrollWidth") <= 390)
    browser.picture("phone")
    check_silent(browser, "the page on a phone")


def check_without_webgl(browser, folder):
    text = (folder / "page.html").read_text()
    off = "<script>HTMLCanvasElement.prototype.getContext = () => null</script><script type=\"application/json\""
    (folder / "off.html").write_text(text.replace("<script type=\"application/json\"", off, 1))
    browser.open(folder / "off.html")
    seen = "(selector => getComputedStyle(document.querySelector(selector)).display)('%s')"
    check("without WebGL the picture is seen", browser.evaluate(seen % ".fallback") == "block")
    check("without WebGL no empty view is seen", browser.evaluate(seen % ".shape") == "none")
    browser.picture("without-webgl")


def main():
    with tempfile.TemporaryDirectory(prefix="homolog-report-") as name:
        folder = pathlib.Path(name)
        for k in range(1, 7):
            run(folder, "phantom", "kidney", "--subject", k, "-o", ".")
        run(folder, "fit", "built-in:kidney", "--mask", *[f"kidney-{k}-labels.nii.gz" for k in range(1, 7)], "-o", "fits")
        cases = [{"name": f"p{k}", "file": f"fits/{path.name}", "group": "one" if k < 4 else "two"}
                 for k, path in enumerate(sorted((folder / "fits").glob("*.ply")), 1)]
        (folder / "s.study.json").write_text(json.dumps({"homolog_study": 1, "cases": cases}))
        run(folder, "model", "s.study.json", "-o", "m.h5.json")
        (folder / "size.recipe.json").write_text(json.dumps({"homolog_recipe": 1, "name": "Size", "measurements": [
            {"name": "content", "kind": "volume"}, {"name": "surface", "kind": "area"}]}))
        run(folder, "report", "s.study.json", "--recipe", "size.recipe.json", "-o", "page.html")
        browser = Browser(folder / "profile")
        try:
            check_page(browser, folder)
            check_without_webgl(browser, folder)
        finally:
            browser.close()
    print("no faults" if not faults else f"{len(faults)} faults")
    return 1 if faults else 0


if __name__ == "__main__":
    sys.exit(main())
