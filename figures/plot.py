#!/usr/bin/env python3
"""Draws figures from the CSV files that Rigproof writes. Copy it and edit it: the files hold all that is shown.

  plot.py paper CSV         the MEMROC paper's experiments (rigproof paper): dots, curves or steps, whatever the file is about
  plot.py noise CSV         the noise of a depth sensor over distance (rigproof sensors --plot)
  plot.py estimation CSV    error over bound, and NEES (bench_estimation)

Figures appear beside the CSV unless -o names a folder; their paths are printed, one a line.
Needs python3-matplotlib. Exit code 2 where that is missing or the file cannot be drawn.
"""
import argparse
import collections
import csv
import math
import os
import statistics
import sys
import textwrap

try:
    import matplotlib
except ImportError:
    system = "/usr/bin/python3"  # the one that apt-get installs for; another may come first on PATH
    if os.path.exists(system) and not os.path.samefile(system, sys.executable):
        os.execv(system, [system] + sys.argv)
    print("python3-matplotlib is missing; install it by: apt-get install python3-matplotlib", file=sys.stderr)
    sys.exit(2)
matplotlib.use("Agg")
import matplotlib.pyplot as plt  # noqa: E402  (the backend is chosen first)
import matplotlib.ticker as ticker  # noqa: E402

# Okabe and Ito's colours, which colour-blind readers tell apart; after the last they repeat, with hollow marks.
COLORS = ["#0072B2", "#D55E00", "#009E73", "#CC79A7", "#E69F00", "#56B4E9", "#8A6FB0", "#7F7F7F"]
INK, GREY = "#222222", "#888888"
AXES = ["tx", "ty", "tz", "roll", "pitch", "yaw"]
MEASURED = ["measured", "far"]  # what is far off is in no mean, but its method is named

plt.rcParams.update({
    "font.size": 8, "axes.titlesize": 8, "axes.edgecolor": GREY, "axes.grid": True, "axes.axisbelow": True,
    "grid.color": "#DDDDDD", "grid.linewidth": 0.6, "figure.dpi": 100, "savefig.dpi": 150,
    "svg.hashsalt": "rigproof", "svg.fonttype": "none", "pdf.fonttype": 42})


def read(path):
    with open(path, newline="") as file:
        return list(csv.DictReader(file))


def number(text):
    return float(text) if text else None


def unique(values):
    return list(dict.fromkeys(values))


def quartiles(values):
    """The 25 % and 75 % quantiles, interpolated between order statistics."""
    if len(values) < 2:
        return values[0], values[0]
    low, _, high = statistics.quantiles(values, n=4, method="inclusive")
    return low, high


def deviation(values):
    return statistics.stdev(values) if len(values) > 1 else 0.0


class Writer:
    """Saves figures, each file whole or not at all, with nothing in it that differs from run to run."""

    def __init__(self, folder, formats):
        self.folder, self.formats = folder, formats

    def save(self, figure, name):
        for suffix in self.formats:
            path = os.path.join(self.folder, name + "." + suffix)
            dates = {"pdf": {"CreationDate": None}, "svg": {"Date": None}}.get(suffix)
            figure.savefig(path + ".part", format=suffix, bbox_inches="tight", metadata=dates)
            os.replace(path + ".part", path)
            print(path)
        plt.close(figure)


def look_of(methods, method):
    """The same colour for the same method in every figure."""
    place = methods.index(method)
    return {"color": COLORS[place % len(COLORS)], "hollow": place >= len(COLORS)}


def head(figure, title, subtitle, entries):
    """Title, and under it the names of the lines, above the charts."""
    lines = math.ceil(len(entries) / 5)
    if entries:
        figure.legend(entries.values(), entries.keys(), loc="lower left", bbox_to_anchor=(0.0, 1.0), frameon=False,
                      ncol=5)
    figure.suptitle(title + "\n" + subtitle, x=0.01, ha="left", va="bottom", size=9,
                    y=1.0 + (0.1 + 0.2 * lines) / figure.get_figheight())


# ---------------------------------------------------------------------------------------------- the paper's experiments

def draw_dots(rows, panels, methods, successes, title, name, writer):
    """A line of six charts a panel: for each method the mean of |error|, its quartiles, and what was published."""
    shown = {panel: [m for m in methods if any(r["panel"] == panel and r["method"] == m and r["source"] in MEASURED
                                               for r in rows)] for panel in panels}
    panels = [panel for panel in panels if shown[panel]]
    heights = [0.8 + 0.2 * len(shown[panel]) for panel in panels]
    figure = plt.figure(figsize=(11, sum(heights) or 1), layout="constrained")
    for panel, part in zip(panels, figure.subfigures(len(panels), 1, height_ratios=heights, squeeze=False)[:, 0]
                           if panels else []):
        part.suptitle(panel, x=0.005, ha="left", weight="bold", size=9)
        names = shown[panel][::-1]
        for axes, quantity in zip(part.subplots(1, len(AXES), sharey=True), AXES):
            own = [r for r in rows if r["panel"] == panel and r["quantity"] == quantity]
            axes.set(xscale="log", title=quantity + (" [%s]" % own[0]["unit"] if own else ""))
            axes.set_yticks(range(len(names)), [m + successes.get((panel, m), "") for m in names])
            axes.set_ylim(-0.7, len(names) - 0.3)
            for y, method in enumerate(names):
                errors = [abs(float(r["error"])) for r in own if r["method"] == method and r["source"] == "measured"]
                published = [float(r["error"]) for r in own if r["method"] == method and r["source"] == "published"]
                color = look_of(methods, method)["color"]
                if errors:
                    axes.plot(quartiles(errors), [y, y], color=color, alpha=0.4, linewidth=3, solid_capstyle="butt")
                    axes.plot(statistics.fmean(errors), y, "o", color=color, markersize=5)
                if published:
                    axes.plot(published[0], y, "o", color=INK, markersize=7, fillstyle="none")
            whole_decades(axes, "x")
    head(figure, title, "disc: mean of |error| of answers within 1 m and 20 deg; line: quartiles; ring: published mean "
         "(Allegro et al. 2024); beside the method in how many tasks it succeeded", {})
    writer.save(figure, name)


def whole_decades(axes, which):
    """Limits of a log axis at powers of ten, so that it has two labels at least, and no more than fit."""
    axis = axes.xaxis if which == "x" else axes.yaxis
    low, high = axis.get_view_interval()
    if low > 0 and math.isfinite(high):
        limits = 10.0 ** math.floor(math.log10(low)), 10.0 ** math.ceil(math.log10(high))
        axes.set(**{which + "lim": limits})
    axis.set_major_locator(ticker.LogLocator(numticks=5))
    axis.set_minor_locator(ticker.NullLocator())


def draw_curves(rows, panels, methods, title, name, writer):
    """Mean length of the error over x, with a band of one standard deviation."""
    figure, grid = plt.subplots(max(1, len(panels)), 2, figsize=(9, 2.4 * max(1, len(panels))), squeeze=False,
                                layout="constrained")
    entries = {}
    for panel, line in zip(panels, grid):
        for axes, quantity in zip(line, ["translation", "rotation"]):
            own = [r for r in rows if r["panel"] == panel and r["quantity"] == quantity]
            axes.set_yscale("log", nonpositive="clip")
            axes.set(title="%s, %s" % (panel, quantity), xlabel=own[0]["x_title"] if own else "",
                     ylabel=own[0]["unit"] if own else "")
            means = []
            for method in methods:
                at = collections.defaultdict(list)
                for row in own:
                    if row["method"] == method and row["source"] == "measured":
                        at[float(row["x"])].append(float(row["error"]))
                if not at:
                    continue
                look = look_of(methods, method)
                xs = sorted(at)
                ys = [statistics.fmean(at[x]) for x in xs]
                spread = [deviation(at[x]) for x in xs]
                means += ys
                axes.fill_between(xs, [y - s for y, s in zip(ys, spread)], [y + s for y, s in zip(ys, spread)],
                                  color=look["color"], alpha=0.12, linewidth=0)
                line, = axes.plot(xs, ys, "o-", color=look["color"], markersize=3.5, linewidth=1.4,
                                  fillstyle="none" if look["hollow"] else "full")
                entries.setdefault(method, line)
            means = [y for y in means if y > 0]
            if means:  # a band may reach down to zero
                axes.set_ylim(10.0 ** math.floor(math.log10(min(means))), 10.0 ** math.ceil(math.log10(max(means))))
    head(figure, title, "mean length of the error of answers within 1 m and 20 deg, with a band of one standard "
         "deviation over tasks and cameras", entries)
    writer.save(figure, name)


def draw_repeatability(rows, camera, methods, writer):
    """Estimate minus mounting in every run; beside them mean and standard deviation."""
    own = [r for r in rows if r["camera"] == camera]
    runs = unique(r["x"] for r in own)
    figure, grid = plt.subplots(2, 3, figsize=(11, 4.6), layout="constrained")
    entries = {}
    for axes, quantity in zip(grid.flat, AXES):
        these = [r for r in own if r["quantity"] == quantity]
        axes.set(title=quantity + (" [%s]" % these[0]["unit"] if these else ""), xlabel="run")
        axes.axhline(0, color=GREY, linewidth=0.8)
        for place, method in enumerate(methods):
            points, apart = (sorted((float(r["x"]), float(r["error"])) for r in these
                                    if r["method"] == method and r["source"] == source)
                             for source in ("measured", "few_motions"))
            look, errors = look_of(methods, method), [y for _, y in points]
            for x, y in apart:
                axes.plot(x, y, "x", color=look["color"], markersize=5)
            if not points:
                continue
            fill = "none" if look["hollow"] else "full"
            line, = axes.plot(*zip(*points), "o-", color=look["color"], markersize=3.5, linewidth=1, fillstyle=fill)
            beside = max(float(x) for x in runs) + 0.9 + 1.4 * place / len(methods)
            axes.errorbar(beside, statistics.fmean(errors), deviation(errors), fmt="o", color=look["color"],
                          markersize=4, fillstyle=fill)
            entries.setdefault(method, line)
        axes.xaxis.set_major_locator(ticker.MaxNLocator(integer=True))
    head(figure, "Repeatability of %s over %d runs" % (camera, len(runs)),
         "estimate minus mounting; at the right mean and standard deviation; cross: fewer than 10 motions, in no mean",
         entries)
    writer.save(figure, "repeatability_" + camera)


def draw_waterfall(rows, panels, title, name, writer):
    """From the first step down: a bar from each mean to the next one, with the interval of what the step changed."""
    steps = {panel: unique((r["x"], r["method"], r["x_title"]) for r in rows if r["panel"] == panel) for panel in panels}
    heights = [0.9 + 0.24 * len(steps[panel]) for panel in panels]
    figure = plt.figure(figsize=(13, sum(heights)), layout="constrained")
    for panel, part in zip(panels, figure.subfigures(len(panels), 1, height_ratios=heights, squeeze=False)[:, 0]):
        part.suptitle(panel, x=0.005, ha="left", weight="bold", size=9)
        names = ["%s: %s" % (method, what) for _, method, what in steps[panel]]
        for axes, quantity in zip(part.subplots(1, len(AXES), sharey=True), AXES):
            own = [r for r in rows if r["panel"] == panel and r["quantity"] == quantity]
            values = {(r["x"], r["source"]): float(r["error"]) for r in own}
            axes.set_title(quantity + (" [%s]" % own[0]["unit"] if own else ""))
            axes.set_yticks(range(len(names)), names)
            axes.set_ylim(len(names) - 0.4, -0.6)
            before = None
            for y, (x, _, _) in enumerate(steps[panel]):
                mean = values.get((x, "mean"))
                if mean is None:
                    continue
                if before is None or y == len(names) - 1:
                    axes.barh(y, mean, color=GREY, height=0.6)
                if before is not None:
                    axes.barh(y, mean - before, left=before, color=COLORS[2] if mean < before else COLORS[1], height=0.6)
                    if (x, "low") in values:
                        axes.plot([before + values[x, "low"], before + values[x, "high"]], [y, y], color=INK,
                                  linewidth=1)
                axes.plot([mean, mean], [y - 0.3, y + 0.3], color=INK, linewidth=1.2)
                before = mean
            axes.set_xlim(0, 1.05 * max([v for (_, source), v in values.items() if source == "mean"] or [1]))
            axes.xaxis.set_major_locator(ticker.MaxNLocator(3))
    head(figure, title, "mean of |error| after each step; green: smaller, orange: larger; line: 95 % of the change", {})
    writer.save(figure, name)


def draw_paper(path, options, writer):
    rows = read(path)
    name = os.path.splitext(os.path.basename(path))[0]
    methods = unique(r["method"] for r in rows)
    title = options.title or name
    successes = {(r["panel"], r["method"]): "  %g/%g" % (float(r["error"]), float(r["x"]))
                 for r in rows if r["figure"] == "success"}
    dots, curves = ([r for r in rows if r["figure"] == kind] for kind in ("dots", "curves"))
    if dots:
        draw_dots(dots, unique(r["panel"] for r in dots), methods, successes, title, name, writer)
    if curves:
        draw_curves(curves, unique(r["panel"] for r in curves), methods, title, name, writer)
    steps = [r for r in rows if r["figure"] == "waterfall"]
    if steps:
        draw_waterfall(steps, unique(r["panel"] for r in steps), title, name, writer)
    repeated = [r for r in rows if r["figure"] == "repeatability"]
    for camera in unique(r["camera"] for r in repeated):
        draw_repeatability(repeated, camera, methods, writer)


# ------------------------------------------------------------------------------------------------------- depth sensors

def draw_noise(path, options, writer):
    rows = read(path)
    figure, axes = plt.subplots(figsize=(6.4, 4), layout="constrained")
    for column, label, style in (("law_mm", "the preset's law", {"color": COLORS[0]}),
                                 ("recorded_mm", "with the rounding of disparity and unit", {"color": COLORS[1]}),
                                 ("simulated_mm", "simulated walls of 640 x 480 pixels",
                                  {"color": INK, "marker": "o", "linestyle": "none"})):
        points = sorted((float(r["z_m"]), float(r[column])) for r in rows if r[column])
        if points:
            axes.plot(*zip(*points), label=label, **style)
    axes.set(xlabel="distance [m]", ylabel="standard deviation of depth [mm]", xlim=(0, None), ylim=(0, None))
    axes.set_title(textwrap.fill(options.title or "Depth noise", 90), loc="left")
    axes.legend(frameon=False)
    writer.save(figure, os.path.splitext(os.path.basename(path))[0])


# -------------------------------------------------------------------------------------------------- estimator and bound

def draw_sheets(rows, title, name, draw, writer):
    """A chart a sheet, with a column for each count of stops and lambda."""
    sheets = unique(r["sheet"] for r in rows)
    columns = max(sum(r["sheet"] == sheet for r in rows) for sheet in sheets)
    figure, grid = plt.subplots(len(sheets), 1, figsize=(max(6, 0.32 * columns), 1.55 * len(sheets)), squeeze=False,
                                layout="constrained")
    for axes, sheet in zip(grid[:, 0], sheets):
        own = [r for r in rows if r["sheet"] == sheet]
        axes.set_title(own[0]["title"], loc="left")
        axes.set_xlim(-0.5, columns - 0.5)
        axes.set_xticks(range(len(own)), ["%g\n%s" % (float(r["lambda"]), "N = " + r["stops"]
                                                     if i == 0 or own[i - 1]["stops"] != r["stops"] else "")
                                          for i, r in enumerate(own)])
        axes.grid(False, axis="x")
        for i, row in enumerate(own):
            if i and own[i - 1]["stops"] != row["stops"]:
                axes.axvline(i - 0.5, color=GREY, linewidth=0.8)
        draw(axes, own)
    figure.suptitle(title, x=0.005, ha="left")
    writer.save(figure, name)


def draw_ratio_columns(axes, rows):
    axes.set_ylim(0.85, 1.3)
    axes.axhline(1, color=GREY)
    axes.axhline(float(rows[0]["ratio_goal"]), color="#C00000", linestyle="--", linewidth=1)
    for i, row in enumerate(rows):
        for k, group in enumerate(["robot", "pair"]):
            for j, axis in enumerate(["tx", "ty", "tz", "rx", "ry", "rz"]):
                ratio, low, high = (number(row.get("%s_%s_%s" % (group, axis, what)))
                                    for what in ("ratio", "lower_99", "upper_99"))
                if not ratio:
                    continue
                x = i - 0.5 + (6 * k + j + 1) / 13
                axes.plot([x, x], [low, high], color=COLORS[k], alpha=0.45, linewidth=0.8)
                axes.plot(x, ratio, ".", color=COLORS[k], markersize=3)


def draw_nees_columns(axes, rows):
    axes.set_ylim(12, 24)
    axes.axhspan(float(rows[0]["nees_goal_low"]), float(rows[0]["nees_goal_high"]), color=COLORS[2], alpha=0.15)
    axes.axhline(18, color=GREY)
    for i, row in enumerate(rows):
        if row.get("nees"):
            axes.errorbar(i, float(row["nees"]), float(row["nees_99_half_width"]), fmt=".", color=INK, linewidth=0.9)


def draw_estimation(path, options, writer):
    # Fewer trials have limits wider than a picture.
    rows = [r for r in read(path) if int(r["trials"]) >= 100]
    if not rows:
        return
    draw_sheets(rows, "RMSE / Cramer-Rao bound over lambda: camera to robot blue, camera to camera orange; tx ty tz rx "
                "ry rz\nwith one-sided 99 % limits; dashed: no lower limit may lie above", "ratios",
                draw_ratio_columns, writer)
    draw_sheets(rows, "NEES of three cameras together over lambda: 18 where the stated covariance is true\n"
                "mean with its two-sided 99 % interval; shaded: the goal (30 % where sigmas are estimated)", "nees",
                draw_nees_columns, writer)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("kind", choices=["paper", "noise", "estimation"])
    parser.add_argument("csv")
    parser.add_argument("-o", "--output", help="folder; default that of the CSV")
    parser.add_argument("--formats", default="png,pdf,svg", help="default png,pdf,svg")
    parser.add_argument("--title")
    options = parser.parse_args()
    folder = options.output or os.path.dirname(os.path.abspath(options.csv))
    writer = Writer(folder, options.formats.split(","))
    draw = {"paper": draw_paper, "noise": draw_noise, "estimation": draw_estimation}[options.kind]
    try:
        draw(options.csv, options, writer)
        return 0
    except OSError as error:
        print(error, file=sys.stderr)
    except (KeyError, ValueError) as error:
        print("%s: cannot be drawn as \"%s\": %s %s" % (options.csv, options.kind, type(error).__name__, error),
              file=sys.stderr)
    return 2


if __name__ == "__main__":
    sys.exit(main())
