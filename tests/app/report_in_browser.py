#!/usr/bin/env python3
"""Opens the report of a small run in chromium: nothing on the console, nothing asked of a network, everything drawn (by
its pixels), controls work, at desktop and phone size, light and dark.

Usage: report_in_browser.py RIGPROOF SMALL_RUN [FOLDER]    FOLDER: keep screenshots there, to be looked at
"""
import base64
import csv
import io
import json
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile
import urllib.parse

import chromium

# A name that would run if it were taken as markup.
HOSTILE = '<img src=x onerror="window.hacked=1"> "q" \' & 🤖 {{data}}'
SECTIONS = ["rig", "poses", "budget", "methods", "images", "corners", "findings", "left-out", "origin"]
SWEEP = """
name: small
mode: geometric
run: {poses: 12}
axes:
  lambda: {field: odometry.lambda, values: [0.5, 8]}
  model: {field: odometry.model, values: [per_increment, per_pose]}
seeds: 3
methods: [ml, joint_memroc]
"""
# How many colours a canvas shows, and a number that changes with its picture.
PIXELS = """((canvas) => {
  const copy = document.createElement("canvas");
  copy.width = canvas.width; copy.height = canvas.height;
  const pen = copy.getContext("2d");
  pen.drawImage(canvas, 0, 0);
  const bytes = pen.getImageData(0, 0, copy.width, copy.height).data, colors = new Set();
  let sum = 0;
  for (let i = 0; i < bytes.length; i += 4) {
    const value = (bytes[i] << 16) | (bytes[i + 1] << 8) | bytes[i + 2];
    colors.add(value);
    sum = (sum * 31 + value) % 1000000007;
  }
  return [colors.size, sum];
})(document.querySelector("CANVAS"))"""

# The longest stretch of a screenshot without anything in it, and its background's grey.
EMPTY_ROWS = """(async () => {
  const picture = new Image();
  picture.src = "data:image/png;base64,PICTURE";
  await picture.decode();
  const canvas = document.createElement("canvas");
  canvas.width = picture.width; canvas.height = picture.height;
  const pen = canvas.getContext("2d");
  pen.drawImage(picture, 0, 0);
  const bytes = pen.getImageData(0, 0, canvas.width, canvas.height).data;
  let longest = 0, run = 0;
  for (let y = 0; y < canvas.height; ++y) {
    const colors = new Set();
    for (let i = 4 * y * canvas.width; i < 4 * (y + 1) * canvas.width; i += 4) colors.add((bytes[i] << 16) | (bytes[i + 1] << 8) | bytes[i + 2]);
    run = colors.size < 4 ? run + 1 : 0;
    longest = Math.max(longest, run);
  }
  return [longest, bytes[4 * (3 * canvas.width + 3)]];
})()"""


def expect(holds, what):
    if not holds:
        raise AssertionError(what)


def make_report(program, small_run, scratch):
    run = scratch / HOSTILE
    shutil.copytree(small_run, run)
    for command in (["calibrate", run, "-m", "ml", "-m", "joint_memroc"], ["report", run]):
        subprocess.run([program, *command, "-q"], check=True)
    return run / "report.html"


def make_sweep_report(program, scratch):
    config = scratch / "sweep.yaml"
    config.write_text(SWEEP)
    folder = scratch / "sweep"
    subprocess.run([program, "sweep", "start", config, "-o", folder, "-q"], check=True)
    subprocess.run([program, "report", folder, "-q"], check=True)
    return folder / "report.html"


def make_history(program, small_run, scratch):
    """Three recordings, in a folder with a name that would run; the first result has one camera elsewhere."""
    days = [scratch / (HOSTILE.replace("data", day)) for day in ("monday", "tuesday", "friday")]
    for day in days:
        shutil.copytree(small_run / "recording", day)
        subprocess.run([program, "observe", day, "-q"], check=True)
        subprocess.run([program, "calibrate", day / "observations.json", "-q"], check=True)
    first = days[0] / "results/ml.yaml"
    text = first.read_text()
    x = re.search(r"translation_m: \[([-0-9.e]+),", text)
    first.write_text(text[:x.start(1)] + str(float(x.group(1)) + 0.05) + text[x.end(1):])
    subprocess.run([program, "report", *days, "-o", scratch / "history.html", "-q"], check=True)
    return scratch / "history.html"


def picture_of(browser, selector):
    browser.settle()
    return browser.js(PIXELS.replace("CANVAS", selector))


def click(browser, selector):
    browser.js(f"document.querySelector({selector!r}).click()")
    browser.settle()


def move(browser, selector, value):
    browser.js(f"""(() => {{ const slider = document.querySelector({selector!r}); slider.value = {value};
                   slider.dispatchEvent(new Event("input")); }})()""")


def check_content(browser):
    expect(browser.js("document.querySelector('h1').textContent") == HOSTILE, "the title is the run's name")
    expect(browser.js("window.hacked") is None, "a name was run")
    expect(browser.js("document.querySelector('.verdict .word').textContent") == "GOOD", "the verdict stands first")
    sections = browser.js("[...document.querySelectorAll('main > section')].map((s) => s.id)")
    expect(sections == SECTIONS, f"the sections are {sections}")
    expect(browser.js("document.querySelectorAll('#poses table')[0].rows.length") == 4, "a row for each of three cameras")
    expect(browser.js("document.querySelectorAll('.forest svg').length") == 6, "a picture of each degree of freedom")
    expect(picture_of(browser, "#view3d canvas")[0] > 50, "the rig is drawn")
    for chart in ("#budget .chart", "#corners .chart"):
        expect(browser.js(f"document.querySelectorAll('{chart} svg path').length") > 10, chart + " is drawn")
    words = browser.js("document.body.innerText").split()
    expect(not {"null", "undefined", "NaN"} & set(words), "nothing that is missing is written as a word")
    expect(browser.js("document.documentElement.scrollWidth <= document.documentElement.clientWidth"), "nothing sticks out")


def check_rig(browser):
    canvas = "#view3d canvas"
    seen = [picture_of(browser, canvas)]
    expect(seen[0][0] > 50, f"the rig is drawn in {seen[0][0]} colours")

    def changes(what):
        seen.append(picture_of(browser, canvas))
        expect(seen[-1][1] != seen[-2][1], what + " changes the picture")

    for box in range(2):
        browser.js(f"document.querySelectorAll('#rig input[type=checkbox]')[{box}].click()")
        changes(f"checkbox {box}")
        browser.js(f"document.querySelectorAll('#rig input[type=checkbox]')[{box}].click()")
        changes(f"checkbox {box}")
    move(browser, "#exaggeration", 2.9)
    changes("the exaggeration")
    move(browser, "#stop", 5)
    changes("another stop")
    browser.js("document.querySelectorAll('#rig button')[2].click()")
    changes("the view from above")
    browser.js(f"document.querySelector('{canvas}').focus()")
    browser.press("ArrowLeft")
    changes("an arrow key")


def check_ellipses(browser):
    """They are as large as the corner's covariance and what no lens model follows make them."""
    drawn, expected = browser.js("""(() => {
      const box = { "lens_residual_px": 0.3 }, frame = data.frames.findIndex((one, index) => one.corners && fitOf(data.results[0], index));
      const camera = data.cameras[data.frames[frame].camera], before = camera.lens_residual_px;
      Object.assign(camera, box);
      const ellipse = cornersClose(data, data.results[0], frame, 10).querySelector("ellipse"), [corner] = cornersOf(data.frames[frame]);
      camera.lens_residual_px = before;
      const drawn = ellipse.getAttribute("rx") ** 2 + ellipse.getAttribute("ry") ** 2;
      return [drawn, 400 * (corner.uu + corner.vv + 2 * 0.3 ** 2)];
    })()""")
    expect(abs(drawn / expected - 1) < 1e-6, f"ellipses of detector and lens: {drawn}, {expected}")


def check_images(browser):
    browser.js("document.getElementById('images').scrollIntoView({behavior: 'instant'})")
    browser.settle()
    browser.settle()
    expect(browser.js("document.querySelector('.frame img').naturalWidth") > 100, "the first image is there")
    click(browser, ".frame")
    expect(browser.js("document.querySelector('dialog').open"), "an image opens")
    expect(browser.js("document.querySelectorAll('dialog ellipse').length") > 5, "expected corners with their ellipses")
    check_ellipses(browser)
    expect("null" not in browser.js("document.querySelector('dialog').innerText"), "nothing missing is written there")
    expect(browser.js("document.querySelectorAll('dialog svg.ground rect').length") > 5, "where the ground is")
    expect("on the ground plane" in browser.js("document.querySelector('dialog').innerText"), "and what green means")
    titles = [browser.js("document.querySelector('dialog h3').textContent")]
    for _ in range(2):
        browser.press("ArrowRight")
        titles.append(browser.js("document.querySelector('dialog h3').textContent"))
    expect(len(set(titles)) == 3, f"an arrow key goes to the next image, each time: {titles}")
    expect(browser.js("document.querySelector('dialog').contains(document.activeElement)"), "the focus stays in the dialog")
    browser.press("Escape")
    expect(not browser.js("document.querySelector('dialog').open"), "escape closes it")
    everything = browser.js("document.querySelectorAll('.frame').length")
    browser.js("""(() => { const s = document.querySelectorAll('#images select')[0]; s.value = 1;
                  s.dispatchEvent(new Event('change')); })()""")
    expect(0 < browser.js("document.querySelectorAll('.frame').length") < everything, "the images of one camera")


def check_corners(browser):
    first = picture_of(browser, "#corners canvas")
    expect(first[0] > 5, "coverage and arrows are drawn")
    browser.js("""(() => { const s = document.querySelector('#corners select'); s.value = 1;
                  s.dispatchEvent(new Event('change')); })()""")
    expect(picture_of(browser, "#corners canvas")[1] != first[1], "differences from the truth are others")


def check_methods(browser):
    button = "document.querySelectorAll('#methods button')[4]"
    browser.js(f"{button}.scrollIntoView({{block: 'center', behavior: 'instant'}}); {button}.focus()")
    where = f"[{button}.getBoundingClientRect().top, ...lastView.camera.position.toArray(), lastView.stop]"
    before = browser.js(where)
    browser.js(button + ".click()")
    browser.settle()
    after = browser.js(where)
    expect(max(abs(a - b) for a, b in zip(before, after)) < 2, f"page and rig stay where they are: {before}, {after}")
    expect(browser.js(f"document.activeElement === {button}"), "the button keeps the focus")
    expect(browser.js("document.querySelector('.top select').selectedOptions[0].textContent") == "joint_memroc",
           "another method is shown")
    expect(picture_of(browser, "#view3d canvas")[0] > 50, "and its rig is drawn")


def copied(browser, section, kind, table=0):
    """What a button beside a table copies."""
    browser.js("window.copyText = async (text) => { window.copied = text; }")
    browser.js(f"""[...document.querySelectorAll("#{section} .copy button")]
                   .filter((button) => button.textContent === "{kind}")[{table}].click()""")
    return browser.js("window.copied")


def check_copies(browser):
    rows = list(csv.reader(io.StringIO(copied(browser, "poses", "CSV"))))
    expect(rows[0][:4] == ["camera", "tx [cm]", "sigma of tx [cm]", "ty [cm]"], f"value and sigma apart: {rows[0]}")
    expect(len(rows) == 4 and {len(row) for row in rows} == {13}, "a row for each of three cameras")
    numbers = [float(text) for row in rows[1:] for text in row[1:]]
    expect(all(value > 0 for value in numbers[1::2]), "sigmas are numbers")
    expect(max(len(text) for text in rows[1]) > 8, f"with all digits: {rows[1]}")
    shown = browser.js("document.querySelector('#poses td').innerText").replace("\u2212", "-").split("±")
    differences = [abs(float(a) - float(b)) for a, b in zip(rows[1][1:3], shown)]
    expect(len(differences) == 2 and max(differences) < 0.06, f"as shown: {rows[1]}, {shown}")
    errors = list(csv.DictReader(io.StringIO(copied(browser, "poses", "CSV", 1))))
    expect(all(row["camera"] and row["kind"] for row in errors), "each row names its camera")
    signed = [float(row[key]) for row in errors for key in row if key.endswith("]") and row["kind"] == "error"]
    expect(len(signed) == 18 and min(signed) < 0 < max(signed), "a minus is one that programs read")
    expect("$\\pm$" in copied(browser, "poses", "LaTeX"), "LaTeX has both in a cell")
    escaped = browser.js(r"asLatex(['a'], [['b~c^d_e\\f']])")
    expect(r"b\textasciitilde{}c\textasciicircum{}d\_e\textbackslash{}f" in escaped, f"LaTeX escapes: {escaped}")
    expect(browser.js("[fixed(-0.001, 1), signed(-0.001, 1), figure(-1e-9)]") == ["0.0", "0.0", "0.000000"], "no minus zero")


def check_paper(browser):
    browser.paper(True)
    shown = browser.js("""[...document.querySelectorAll("select, input, .copy")]
                          .filter((node) => node.getClientRects().length).length""")
    expect(shown == 0, f"{shown} controls are printed")
    expect(browser.js("document.querySelector('#images .printed').getClientRects().length") == 1, "what is chosen is")
    expect(browser.js("getComputedStyle(document.querySelector('h2')).breakAfter") == "avoid", "no heading ends a page")
    expect(browser.js("document.querySelector('footer').getClientRects().length") == 0, "nor do licences have one")
    wide = "document.querySelector('#view3d').clientWidth / document.querySelector('#view3d').clientHeight"
    expect(abs(browser.js("lastView.paper.width / lastView.paper.height") - browser.js(wide)) < 0.01, "the rig is not squeezed")
    browser.paper(False)
    canvas = "document.querySelector('#view3d canvas')"
    expect(abs(browser.js(f"{canvas}.width / {canvas}.height") - browser.js(wide)) < 0.01, "nor is it afterwards")
    folded = "document.querySelectorAll('details:not([open])').length"
    before = browser.js(folded)
    browser.js("dispatchEvent(new Event('beforeprint'))")
    expect(before > 0 and browser.js(folded) == 0, "what is folded is printed")
    browser.js("dispatchEvent(new Event('afterprint'))")
    expect(browser.js(folded) == before, "and folded again")


def check_theme(browser):
    """Dots beside names follow the theme, and are light on paper."""
    dot = "getComputedStyle(document.querySelector('#poses tbody .dot')).backgroundColor"
    browser.dark(True)
    browser.settle()
    on_dark = browser.js(dot)
    browser.paper(True)
    on_paper = browser.js(dot)
    browser.paper(False)
    browser.dark(False)
    browser.settle()
    expect(browser.js(dot) == on_paper != on_dark, f"{on_dark} on dark, {on_paper} on paper")
    expect(browser.js("['#0072b2', '#e69f00', '#56b4e9'].map(inkOn)") == ["#fff", "#111", "#111"], "numbers can be read on bars")


def give_long_names(data):
    """Cameras as ROS names their frames, one as long as names may be; a finding with code in it."""
    names = ["front_left_camera_color_optical_frame", "front_right_camera_color_optical_frame", "r" * 64]
    renamed = {camera["name"]: name for camera, name in zip(data["cameras"], names)}
    text = json.dumps({key: data[key] for key in ("cameras", "results")})
    for old, new in renamed.items():
        text = text.replace(json.dumps(old), json.dumps(new))
    data.update(json.loads(text))
    for result in data["results"]:
        result["notes"].append({"code": "a.code", "severity": "suspect", "sentence": "State `square_mm` and `sigma`.", "remedy": "Use `rig.yaml`."})


def check_long_names(browser, page):
    for width, height in ((1280, 900), (390, 844)):
        browser.size(width, height, width < 600)
        browser.open(url_of(page))
        expect(browser.js("document.documentElement.scrollWidth <= document.documentElement.clientWidth"), f"nothing sticks out of {width}")
        cut = browser.js("""[...document.querySelectorAll(".frame .caption")].filter((node) => node.scrollWidth > node.clientWidth).length""")
        expect(cut == 0, f"{cut} captions are cut at {width}")
        name, dot = browser.js("""["#corners .named .dot + span", "#corners .named .dot"].map((selector) =>
            document.querySelector(selector).getBoundingClientRect().top)""")
        expect(0 <= dot - name < 16, f"a name begins beside its dot: {name}, {dot}")
    expect(browser.js("labelNames(['front_left_camera_optical_frame', 'front_right_camera_optical_frame'])")
           == ["front_left", "front_right"], "labels leave out what all share")
    expect(max(len(name) for name in browser.js("lastView.names")) <= 18, "and are short")
    finding = browser.js("[...document.querySelectorAll('#findings li')].at(-1).innerHTML")
    expect("<code>square_mm</code>" in finding and "<code>rig.yaml</code>" in finding and "`" not in finding, f"code is code: {finding}")


def check_whole_page(browser, name, folder):
    """By a screenshot: no empty stretch as high as a window; returns how light the background is."""
    height = browser.js("document.documentElement.scrollHeight")
    width = browser.js("document.documentElement.clientWidth")
    png = browser.screenshot(x=0, y=0, width=width, height=height)
    if folder:
        (folder / (name + ".png")).write_bytes(png)
    longest, background = browser.js(EMPTY_ROWS.replace("PICTURE", base64.b64encode(png).decode()))
    expect(longest < 400, f"{name}: {longest} pixels of the page are empty")
    return background


def choose(browser, select, number):
    browser.js(f"""(() => {{ const select = document.querySelectorAll("select")[{select}]; select.value = {number};
                   select.dispatchEvent(new Event("change")); }})()""")
    browser.settle()


def choose_in(browser, section, select, number):
    browser.js(f"""(() => {{ const select = document.querySelectorAll("#{section} select")[{select}]; select.value = {number};
                   select.dispatchEvent(new Event("change")); }})()""")
    browser.settle()


def check_sweep(browser, page, name, folder):
    browser.open(url_of(page))
    expect("12 tasks, 2 methods" in browser.js("document.querySelector('.verdict').innerText"), "what was done comes first")
    for chart in ("success", "errors", "nees", "boxes"):
        expect(browser.js(f"document.querySelectorAll('#{chart} .chart svg path').length") > 5, chart + " is drawn")
    expect(browser.js("document.querySelectorAll('#figures tbody tr').length") == 4, "two levels of two methods")
    expect(browser.js("document.querySelectorAll('#map tbody td').length") == 4, "a cell for each two levels")
    expect("ml" in browser.js("document.querySelector('#nees ul').innerText"), "NEES in words")
    expect(browser.js("document.documentElement.scrollWidth <= document.documentElement.clientWidth"), "nothing sticks out")
    before = browser.js("document.querySelector('#figures table').innerText")
    choose(browser, 1, 7)
    expect(browser.js("document.querySelector('#figures table').innerText") != before, "rotations differ from translations")
    expect("deg" in browser.js("document.querySelector('#figures h3').innerText"), "the unit follows")
    check_whole_page(browser, name, folder)


def bands(browser):
    return browser.js("""document.querySelectorAll("#errors svg path[fill-opacity='0.16']").length""")


def click_legend(browser, method):
    browser.js("document.getElementById('errors').scrollIntoView({behavior: 'instant'})")
    browser.settle()
    browser.click_at(*browser.js("""((method) => { const text = [...document.querySelectorAll("#errors svg text")]
        .find((node) => node.textContent === method).getBoundingClientRect();
        return [text.x + text.width / 2, text.y + text.height / 2]; })(METHOD)""".replace("METHOD", json.dumps(method))))


def check_legend(browser, page):
    """A method that is switched off takes its band along, and stays off when something else is chosen."""
    browser.open(url_of(page))
    expect(bands(browser) == 2, f"a band for each of two methods: {bands(browser)}")
    click_legend(browser, "joint_memroc")
    expect(bands(browser) == 1, f"the band of the other method alone: {bands(browser)}")
    choose_in(browser, "controls", 1, 7)
    expect(bands(browser) == 1, "it stays off")


def check_method_boxes(browser, page):
    """Without a mouse: a box for each method, of all charts."""
    browser.open(url_of(page))
    box = """[...document.querySelectorAll("#controls label")].find((label) => label.textContent === "ml").querySelector("input")"""
    boxes = "document.querySelectorAll('#boxes svg path[fill=\"transparent\"], #boxes svg path').length"
    before = browser.js(boxes)
    browser.js(box + ".click()")
    browser.settle()
    expect(bands(browser) == 1, "the band of the other method alone")
    expect(browser.js(boxes) < before, "and its box")
    browser.js(box + ".click()")
    browser.settle()
    expect(bands(browser) == 2 and browser.js(boxes) == before, "and back")
    click_legend(browser, "ml")
    expect(bands(browser) == 1 and not browser.js(box + ".checked"), "a legend is of all charts, too, and the box follows")


def check_fields(browser, page):
    """An axis of numbers ends at the data; names are boxes, not lines."""
    browser.open(url_of(page))
    for _ in ("linear", "logarithmic"):
        labels = set(browser.js("[...document.querySelectorAll('#success svg text')].map((node) => node.textContent)"))
        expect({"0.5", "8"} <= labels and not {"0", "0.1", "10"} & labels, f"the axis goes from 0.5 to 8: {labels}")
        browser.js("document.querySelectorAll('#controls input')[1].click()")
        browser.settle()
    expect(bands(browser) == 2, "bands over numbers")
    choose_in(browser, "controls", 3, 1)
    expect(bands(browser) == 0, "no bands over names")
    expect("whiskers" in browser.js("document.querySelector('#errors').innerText"), "but boxes")
    expect(browser.js("document.querySelectorAll('#controls label[hidden]').length") == 2, "no log axis, no filter of itself")


def changed(page, name, change):
    """The same report with other data; columns are plain lists."""
    text = page.read_text()
    start = text.index('id="report-data">') + len('id="report-data">')
    end = text.index("</script>", start)
    data = json.loads(text[start:end])
    for column, values in data.get("rows", {}).items():
        if isinstance(values, dict):
            runs = values["runs"]
            data["rows"][column] = [value for value, count in zip(runs[::2], runs[1::2]) for _ in range(count)]
    change(data)
    other = page.with_name(name)
    other.write_text(text[:start] + json.dumps(data).replace("<", "\\u003c") + text[end:])
    return other


def begin_at_0_with_refusals(data):
    """Had the sweep begun at 0, and one method refused half of it."""
    data["axes"][0].update(levels=["0", "8"], values=[0, 8])
    data["statuses"].append("refused")
    rows = data["rows"]
    for i, task in enumerate(rows["task"]):
        if data["tasks"][task][0] == 1 and rows["method"][i] == 1:
            rows["error"][i] = rows["sigma"][i] = rows["nees"][i] = None
            rows["status"][i] = len(data["statuses"]) - 1


def leave_half_undone(data):
    """Had one method not been run at the second level yet, and one task of the other."""
    rows = data["rows"]
    undone = {(1, task) for task, levels in enumerate(data["tasks"]) if levels[0] == 1}
    undone.add((0, min(task for _, task in undone)))
    kept = [i for i, task in enumerate(rows["task"]) if (rows["method"][i], task) not in undone]
    for column in rows:
        rows[column] = [rows[column][i] for i in kept]


def check_unfinished(browser, page):
    """What is not run is a gap and no failure."""
    browser.open(url_of(page))
    answered = browser.js("[...document.querySelectorAll('#figures tbody tr')].map((row) => row.cells[2].innerText)")
    expect([text.split()[-1] for text in answered] == ["6", "6", "5", "\u2013"], f"of what is run: {answered}")
    points = browser.js("""((view) => successOption(view, view.gather()).series
                           .map((series) => series.data.map(([, share]) => share)))(new SweepView(data))""")
    expect(points[0] == [100, 100] and points[1][0] > 0 and points[1][1] is None, f"a gap where nothing is run: {points}")
    browser.js("document.querySelectorAll('#controls input')[0].click()")
    expect(not browser.said, "and nothing else minds")


def write_long_titles(data):
    """Fields with titles as long as a sentence, and a reason of three lines."""
    for axis in data["axes"]:
        axis["title"] = "standard deviation of the wheels' angles about the vertical axis of " + axis["title"]
    reason = "The drive does not determine `x` and `y`: every stop has the same heading. " * 3
    data["failures"] = [{"method": "joint_memroc", "status": "refused", "code": "motion.straight", "reason": reason, "tasks": 3}]


def check_narrow(browser, page):
    """On a phone everything is read without scrolling the page, or the table of failures, sideways."""
    browser.size(390, 844, True)
    browser.open(url_of(page))
    width = browser.js("document.documentElement.scrollWidth")
    expect(width <= 390, f"the page is {width} pixels wide")
    expect(browser.js("document.querySelector('#failures .scroll').classList.contains('wide')") is False, "failures fit")
    expect(browser.js("document.querySelectorAll('#failures td code').length") == 7, "code in a reason, three times two, and the code itself")
    expect("for example" in copied(browser, "failures", "CSV"), "of several tasks a reason is an example")
    browser.size(1280, 900)


def check_degenerate(browser, page):
    browser.open(url_of(page))
    expect("no log axis: a level is 0" in browser.js("document.querySelector('#controls').innerText"), "why there is none")
    cells = "[...document.querySelectorAll('#map tbody td')].map((cell) => [cell.innerText, cell.className])"
    expect(browser.js("document.querySelector('#map h3').innerText") == "Median |error| of translation [cm], ml", "what it shows")
    expect(all(float(text) > 0 for text, _ in browser.js(cells)), "ml answers everywhere")
    choose_in(browser, "map", 2, 1)
    expect([text == "refused" for text, _ in browser.js(cells)] == [False, True] * 2, f"{browser.js(cells)}")
    expect([kind == "hatched" for _, kind in browser.js(cells)] == [False, True] * 2, "and hatched")
    for quantity, refused in ((1, "0"), (2, "100")):
        choose_in(browser, "map", 0, quantity)
        shares = [text for text, _ in browser.js(cells)]
        expect(shares[1::2] == [refused] * 2 and refused not in shares[::2], f"shares: {shares}")
    rows = list(csv.DictReader(io.StringIO(copied(browser, "map", "CSV"))))
    expect([row["refused"] for row in rows][1::2] == ["3"] * 2, f"counts are copied: {rows}")
    expect(all(int(row["answered"]) > 0 for row in rows[::2]), f"the others are answered: {rows}")
    choose_in(browser, "map", 2, 0)
    choose_in(browser, "map", 0, 3)
    expect("NEES" in browser.js("document.querySelector('#map h3').innerText"), "what it shows")
    expect(all(float(text) > 0 for text, _ in browser.js(cells)), "NEES of ml")
    choose_in(browser, "controls", 3, 1)
    expect(browser.js("document.querySelector('#map thead th').innerText") == "lambda", "fields change places")


def check_history(browser, page, folder):
    for name, width, height, mobile in (("history", 1280, 900, False), ("history_phone", 390, 844, True)):
        browser.size(width, height, mobile)
        browser.dark(mobile)
        browser.open(url_of(page))
        expect(browser.js("document.querySelector('.verdict .word').textContent") == "MOVED", "the verdict stands first")
        expect("left moved between" in browser.js("document.querySelector('.verdict').innerText"), "and names the camera")
        expect(browser.js("document.querySelectorAll('#drift svg[role=img]').length") == 6, "a picture of each axis")
        expect(browser.js("document.querySelectorAll('#drift svg circle').length") > 50, "with its points")
        expect(browser.js("document.querySelectorAll('#verdicts tbody tr').length") == 6, "two recordings, three cameras")
        expect(browser.js("document.querySelectorAll('#poses tbody tr').length") == 9, "three recordings, three cameras")
        words = browser.js("document.body.innerText").split()
        expect(not {"null", "undefined", "NaN"} & set(words), "nothing that is missing is written as a word")
        expect(browser.js("document.documentElement.scrollWidth <= document.documentElement.clientWidth"), "nothing sticks out")
        check_whole_page(browser, name, folder)
    named = "fittingNames(['2026-01-01', '2026-02-01', '2026-03-01'], [0, PLACE, 1], 52, 326).map(({ name }) => name)"
    expect(browser.js(named.replace("PLACE", "0.5")) == ["2026-01-01", "2026-02-01", "2026-03-01"], "a recording in the middle is named")
    expect(browser.js(named.replace("PLACE", "0.1")) == ["2026-01-01", "2026-03-01"], "where there is room")
    before = browser.js("document.querySelectorAll('#drift svg circle').length")
    choose(browser, 0, 1)
    expect(browser.js("document.querySelectorAll('#drift svg circle').length") < before, "one camera alone")
    expect(browser.js("window.hacked") is None, "a name was run")


def url_of(page):
    return "file://" + urllib.parse.quote(str(page))


def check(browser, page, sweep, history, folder):
    url = url_of(page)
    for name, width, height, mobile, dark in (("desktop", 1280, 900, False, False), ("phone", 390, 844, True, True)):
        browser.size(width, height, mobile)
        browser.dark(dark)
        browser.open(url)
        check_content(browser)
        background = check_whole_page(browser, name, folder)
        expect((background < 60) == dark, f"{name}: background {background}")
        check_images(browser)
        if not mobile:
            check_rig(browser)
            check_corners(browser)
            check_copies(browser)
            check_paper(browser)
            check_theme(browser)
            check_methods(browser)
    check_long_names(browser, changed(page, "long.html", give_long_names))
    for name, width, height, mobile, dark in (("sweep_phone", 390, 844, True, True), ("sweep", 1280, 900, False, False)):
        browser.size(width, height, mobile)
        browser.dark(dark)
        check_sweep(browser, sweep, name, folder)
    check_legend(browser, sweep)
    check_fields(browser, sweep)
    check_method_boxes(browser, sweep)
    check_narrow(browser, changed(sweep, "titles.html", write_long_titles))
    check_unfinished(browser, changed(sweep, "unfinished.html", leave_half_undone))
    check_degenerate(browser, changed(sweep, "refusals.html", begin_at_0_with_refusals))
    check_history(browser, history, folder)
    expect(browser.pdf()[:5] == b"%PDF-", "it prints")
    expect(not browser.said, "the console says: " + "\n".join(browser.said))
    expect(not browser.asked_for, f"it asks a network for {browser.asked_for}")


def main():
    if not chromium.program():
        print("there is no chromium")
        return 77
    program, small_run = sys.argv[1:3]
    folder = pathlib.Path(sys.argv[3]) if len(sys.argv) > 3 else None
    with tempfile.TemporaryDirectory() as scratch:
        page = make_report(program, small_run, pathlib.Path(scratch))
        sweep = make_sweep_report(program, pathlib.Path(scratch))
        history = make_history(program, pathlib.Path(small_run), pathlib.Path(scratch))
        browser = chromium.Chromium()
        try:
            check(browser, page, sweep, history, folder)
        finally:
            browser.close()
    return 0


if __name__ == "__main__":
    sys.exit(main())
