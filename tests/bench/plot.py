"""Draws a benchmark's curves and bars; matplotlib is needed only here."""
import textwrap

# Characters of a title that a plot's width surely holds, whatever font a reader's program takes for ours.
TITLE_WIDTH = 60


def check(fail):
    try:
        import matplotlib
    except ImportError:
        fail("drawing needs matplotlib in /usr/bin/python3: docker/dependencies.sh --group all installs it (python3-matplotlib)")
    matplotlib.use("svg")
    # Text stays text, and the same figures give the same file.
    matplotlib.rcParams.update({"svg.fonttype": "none", "svg.hashsalt": "trochoid", "font.size": 9})


def draw_bars(axis, one):
    groups = one["bars"]
    width = 0.8 / len(groups)
    for i, group in enumerate(groups):
        places = [at + (i - (len(groups) - 1) / 2) * width for at in range(len(one["categories"]))]
        bars = axis.bar(places, group["values"], width, label=group["name"], alpha=0.45 if group.get("dashed") else 1.0)
        axis.bar_label(bars, [f"{value:.2g}" if 0 < value < 1 else f"{value:.3g}" for value in group["values"]],
                       fontsize="xx-small" if len(groups) > 3 else "x-small", padding=1)
    crowded = len(one["categories"]) > 5
    axis.set_xticks(range(len(one["categories"])), one["categories"], fontsize="small" if crowded else None)
    if one.get("log"):
        axis.set_yscale("log")
    axis.margins(y=0.15)
    axis.grid(axis="y", alpha=0.3)


def draw_curves(axis, one):
    for curve in one["curves"]:
        # Too many points for marks of their own are drawn as a line alone.
        mark = "o" if len(curve["x"]) <= 30 else ""
        style = "s" if curve.get("points") else ("--" if curve.get("dashed") else "-") + mark
        axis.plot(curve["x"], curve["y"], style, markersize=5 if curve.get("points") else 3, label=curve["name"])
    if one.get("log"):
        axis.set_xscale("log")
    if one.get("log") or one.get("log_y"):
        axis.set_yscale("log")
    axis.grid(alpha=0.3)


def add_legend(axis, one):
    """In the emptiest corner of curves; bars fill theirs, so their names stand below."""
    if "bars" not in one:
        axis.legend(fontsize="small")
        return
    axis.legend(fontsize="small", loc="upper center", bbox_to_anchor=(0.5, -0.16), ncols=min(len(one["bars"]), 2), frameon=False)


def draw(result, file, fail):
    """plots: a list of {title, x, y, log (true: both axes), log_y, curves: [{name, x, y, dashed, points (true: no line)}]}, or of
    {title, x, y, log (true: the values' axis), categories, bars: [{name, values, dashed (true: paler)}]}."""
    plots = result.get("plots")
    if not plots:
        fail(f"{result['id']} draws no curve")
    import matplotlib.pyplot as plt

    # At most three side by side.
    columns = min(len(plots), 3)
    rows = -(-len(plots) // columns)
    figure, axes = plt.subplots(rows, columns, figsize=(6.4 * columns, 4.8 * rows), squeeze=False, layout="constrained")
    for axis in list(axes.flat)[len(plots):]:
        axis.set_axis_off()
    for axis, one in zip(axes.flat, plots):
        (draw_bars if "bars" in one else draw_curves)(axis, one)
        axis.set(title=textwrap.fill(one["title"], TITLE_WIDTH), xlabel=one["x"], ylabel=one["y"])
        add_legend(axis, one)
    figure.savefig(file, metadata={"Date": None})
    plt.close(figure)
    print(f"bench: drew {file}")
