#!/usr/bin/env python3
"""Draws the README's sheets of pictures, one by a server and an offscreen viewer each: gallery.png (nine scenes),
presets.png (the viewer's presets), meshers.png (one view by four meshers, with their triangles).

usage: docker/pictures/gallery.py [--bin DIR] [--out DIR] [SHEET…]        (build/release/bin, docker/pictures, all sheets)

Needs a Release build, and numpy and matplotlib (python3-matplotlib). The sea moves on while a viewer starts, so two runs differ.
"""
import argparse
import os
import subprocess
import sys
import tempfile
import time

import matplotlib.image
import numpy

ROOT = os.path.dirname(os.path.dirname(os.path.dirname(os.path.abspath(__file__))))
WIDTH, HEIGHT = 480, 270


def view(scene, camera, *options):
    return scene, [f"--camera={camera}", "--quality=high", *options]


# Columns, and scenes with what the viewer is asked for (cameras: X, Y, Z, yaw, pitch).
SHEETS = {
    "gallery": (3, [
        view("ship-wakes", "-250,40,480,50,-14"),
        view("round-waves", "-1700,200,0,90,-14"),
        view("irregular-heights", "-600,160,0,90,-12"),
        view("plane-beach", "-200,330,1000,50,-28"),
        view("breakwater", "-250,180,500,55,-24"),
        view("circular-island", "-900,110,500,62,-11"),
        view("harbour", "300,260,900,-12,-22"),
        view("storm-40", "0,18,0,15,-3"),
        view("storm-cell", "-24000,60,16000,45,-4"),
    ]),
    "presets": (2, [
        ("breeze-2", ["--preset=calm"]),
        ("storm-40", ["--preset=storm"]),
        ("harbour", ["--preset=harbour"]),
        ("pierson-moskowitz", ["--preset=gale"]),
    ]),
    "meshers": (2, [
        ("scilly", ["--camera=-9000,45,5000,60,-17", "--error-px=24", "--no-far-sea", "--debug=wireframe", "--mesher=" + mesher])
        for mesher in ("patches", "uniform", "projected", "coherent")
    ]),
}


def shot(bin_dir, folder, scene, options):
    port_file, picture = os.path.join(folder, scene + ".port"), os.path.join(folder, scene + ".png")
    if os.path.exists(port_file):
        os.remove(port_file)
    toml = os.path.join(ROOT, "server/scenes", scene, "scene.toml")
    server = subprocess.Popen([os.path.join(bin_dir, "trochoid-server"), "--scene", toml, "--port", "0", "--port-file",
                               port_file], stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    try:
        for _ in range(600):
            if os.path.exists(port_file) or server.poll() is not None:
                break
            time.sleep(0.1)
        with open(port_file, encoding="ascii") as file:
            address = "127.0.0.1:" + file.read().strip()
        subprocess.run([os.path.join(bin_dir, "trochoid-viewer"), "--connect", address, "--offscreen", "--seconds", "3",
                        "--no-settings", f"--size={2 * WIDTH}x{2 * HEIGHT}", *options, "--picture", picture],
                       check=True)
    finally:
        server.terminate()
        server.wait()
    pixels = matplotlib.image.imread(picture)[:, :, :3]
    # Two by two pixels become one.
    return pixels.reshape(HEIGHT, 2, WIDTH, 2, 3).mean(axis=(1, 3))


def main():
    parser = argparse.ArgumentParser(prog="gallery.py", description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("sheet", nargs="*", help=f"of {', '.join(SHEETS)}")
    parser.add_argument("--bin", default=os.path.join(ROOT, "build/release/bin"))
    parser.add_argument("--out", default=os.path.join(ROOT, "docker/pictures"))
    wanted = parser.parse_args()
    for sheet in wanted.sheet:
        if sheet not in SHEETS:
            sys.exit(f"gallery: no sheet {sheet}: there are {', '.join(SHEETS)}")
    if not os.path.exists(os.path.join(wanted.bin, "trochoid-viewer")):
        sys.exit(f"gallery: no trochoid-viewer in {wanted.bin}: build first (./demo.sh --build-only)")
    for sheet in wanted.sheet or SHEETS:
        columns, shots = SHEETS[sheet]
        with tempfile.TemporaryDirectory() as folder:
            tiles = [shot(wanted.bin, folder, *one) for one in shots]
        rows = [numpy.concatenate(tiles[i:i + columns], axis=1) for i in range(0, len(tiles), columns)]
        out = os.path.join(wanted.out, sheet + ".png")
        matplotlib.image.imsave(out, numpy.concatenate(rows, axis=0))
        print(out)


if __name__ == "__main__":
    main()
