"""Reads a golden file of a sea (tests/golden/sea.txt, edges.txt, fields.txt): the lines by kind, and the sea's records."""
from collections import defaultdict

import sea_records as records
from binary32 import from_bits
from sea import Sea


def _float(word):
    return from_bits(int(word, 16))


def _noise(w):
    return records.Noise(_float(w[0]), *map(int, w[1:]))


def _wake(w):
    return records.Wake(*map(_float, w[:3]), *map(int, w[3:]))


def train_of(w):
    """A train from its seven words."""
    return records.Train(*map(int, w[:4]), _float(w[4]), _float(w[5]), int(w[6]))


class GoldenSea:
    """lines[kind] holds the words of each line of that kind; `sea` is the sea of its records."""

    def __init__(self, path=None, lines=()):
        self.lines = defaultdict(list)
        self.boxes, self.blocks = [], {}
        self._field = None
        if path:
            with open(path, encoding="utf-8") as file:
                lines = file.read().splitlines()
        for line in lines:
            words = line.split()
            if words and words[0] != "#":
                self._take(words[0], words[1:])
        self.sea = Sea(self.boxes, self.blocks)

    def _take(self, kind, words):
        if kind == "box":
            self.boxes.append(records.Box(*map(int, words)))
        elif kind == "leg":
            self._add(course=(records.Leg(*map(int, words)),))
        elif kind == "overlay":
            self._add(overlays=(tuple(map(int, words)),))
        elif kind == "train":
            self._add(trains=(train_of(words),))
        elif kind == "irregular":
            self._set(irregular=records.Irregular(*map(int, words)))
        elif kind == "noise":
            self._set(noise=_noise(words))
        elif kind == "wake":
            self._set(wake=_wake(words))
        elif kind == "field":
            self._field = tuple(map(int, words))
        elif kind == "block":
            x, z, *planes = map(int, words)
            field, step = self._field
            self.blocks[field, x, z] = records.Block(step, tuple(planes[:289]), tuple(planes[289:578]), tuple(planes[578:]))
        else:
            self.lines[kind].append(words)

    def _set(self, **fields):
        self.boxes[-1] = self.boxes[-1]._replace(**fields)

    def _add(self, **lists):
        self._set(**{name: getattr(self.boxes[-1], name) + more for name, more in lists.items()})
