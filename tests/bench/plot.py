"""Draws a benchmark's curves; matplotlib is needed only here."""


def check(fail):
    try:
        import matplotlib
    except ImportError:
        fail("--plot needs matplotlib: docker/dependencies.sh --group all installs it (python3-matplotlib)")
    matplotlib.use("svg")


def draw(result, file, fail):
    """plots: a list of {title, x, y, log (true: both axes), curves: [{name, x, y, dashed}]}."""
    plots = result.get("plots")
    if not plots:
        fail(f"{result['id']} draws no curve")
    import matplotlib.pyplot as plt

    figure, axes = plt.subplots(1, len(plots), figsize=(6.4 * len(plots), 4.4), squeeze=False)
    for axis, one in zip(axes[0], plots):
        for curve in one["curves"]:
            axis.plot(curve["x"], curve["y"], "--o" if curve.get("dashed") else "-o", markersize=3, label=curve["name"])
        axis.set(title=one["title"], xlabel=one["x"], ylabel=one["y"])
        if one.get("log"):
            axis.set_xscale("log")
            axis.set_yscale("log")
        axis.grid(alpha=0.3)
        axis.legend(fontsize="small")
    figure.tight_layout()
    figure.savefig(file)
    print(f"bench: drew {file}")
