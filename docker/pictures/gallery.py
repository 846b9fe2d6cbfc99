#!/usr/bin/env python3
"""Draws gallery.png: one picture of each of nine scenes, by a server and an offscreen viewer each.

usage: docker/pictures/gallery.py [BIN_DIR [FILE.png]]        (build/release/bin, docker/pictures/gallery.png)

Needs a Release build, and numpy and matplotlib (python3-matplotlib). The sea moves on while a viewer starts, so two runs differ.
"""
import os
import subprocess
import sys
import tempfile
import time

import matplotlib.image
import numpy

ROOT = os.path.dirname(os.path.dirname(os.path.dirname(os.path.abspath(__file__))))
WIDTH, HEIGHT = 480, 270
# scene, camera (X, Y, Z, yaw, pitch)
SHOTS = [
    ("ship-wakes", "-250,40,480,50,-14"),
    ("round-waves", "-1700,200,0,90,-14"),
    ("irregular-heights", "-600,160,0,90,-12"),
    ("plane-beach", "-200,330,1000,50,-28"),
    ("breakwater", "-250,180,500,55,-24"),
    ("circular-island", "-900,110,500,62,-11"),
    ("harbour", "300,260,900,-12,-22"),
    ("storm-40", "0,18,0,15,-3"),
    ("storm-cell", "-24000,60,16000,45,-4"),
]


def shot(bin_dir, folder, scene, camera):
    port_file, picture = os.path.join(folder, scene + ".port"), os.path.join(folder, scene + ".png")
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
                        f"--size={2 * WIDTH}x{2 * HEIGHT}", f"--camera={camera}", "--quality=high", "--picture", picture],
                       check=True)
    finally:
        server.terminate()
        server.wait()
    pixels = matplotlib.image.imread(picture)[:, :, :3]
    # Two by two pixels become one.
    return pixels.reshape(HEIGHT, 2, WIDTH, 2, 3).mean(axis=(1, 3))


def main():
    bin_dir = sys.argv[1] if len(sys.argv) > 1 else os.path.join(ROOT, "build/release/bin")
    out = sys.argv[2] if len(sys.argv) > 2 else os.path.join(ROOT, "docker/pictures/gallery.png")
    if not os.path.exists(os.path.join(bin_dir, "trochoid-viewer")):
        sys.exit(f"gallery: no trochoid-viewer in {bin_dir}: build first (./demo.sh --build-only)")
    with tempfile.TemporaryDirectory() as folder:
        tiles = [shot(bin_dir, folder, *one) for one in SHOTS]
    rows = [numpy.concatenate(tiles[i:i + 3], axis=1) for i in range(0, 9, 3)]
    matplotlib.image.imsave(out, numpy.concatenate(rows, axis=0))
    print(out)


if __name__ == "__main__":
    main()
