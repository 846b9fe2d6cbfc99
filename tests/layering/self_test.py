#!/usr/bin/env python3
"""Proves that layering.py finds each kind of violation at its file and line, and leaves good files alone."""

import contextlib
import io
import pathlib
import sys
import tempfile
import unittest

sys.dont_write_bytecode = True  # nothing is left in the source tree
import layering  # noqa: E402

TABLE = """
[folders]
protocol/units  :
protocol/model  : protocol/units
protocol/codec  : protocol/model
server/world    : protocol/units protocol/model
                  protocol/codec/messages.hpp
server/net      : protocol/units
server          : server/net
client/net      : protocol/units
tests/unit      : *

[libraries]
boost/asio.hpp boost/asio/* : server/net client/net
unistd.h sys/* : server/net/process.cpp
*_generated.h : none
random : tests

[words]
(?<![\\w.>:])(std::)?(sin|pow)f?\\( : protocol/model server/world
"""


class Layering(unittest.TestCase):
    def violations(self, files, table=TABLE, readmes=True):
        """The 'file:line: rule' texts for a tree of these files (path -> text)."""
        with tempfile.TemporaryDirectory() as folder:
            root = pathlib.Path(folder)
            rules = root / "layers.txt"
            rules.write_text(table, encoding="utf-8")
            parsed = layering.Table(rules)
            folders = [f for f in parsed.folders if "/" in f] if readmes else []
            for path, text in {**{f"{f}/README.md": "**Knows**\n" for f in folders}, **files}.items():
                file = root / path
                file.parent.mkdir(parents=True, exist_ok=True)
                file.write_text(text, encoding="utf-8")
            found, _, _ = layering.check_tree(parsed, root)
            return [f"{path}:{line}: {rule}" for path, line, rule in found]

    def assert_one(self, files, place, *words, **more):
        found = self.violations(files, **more)
        self.assertEqual(len(found), 1, found)
        self.assertTrue(found[0].startswith(f"{place}: "), found[0])
        for word in words:
            self.assertIn(word, found[0])

    def test_good_files(self):
        good = {
            "protocol/model/sea.hpp": '#pragma once\n#include <cmath>\n#include "protocol/units/lattice.hpp"\n'
            '#include "protocol/model/train.hpp"\n// std::sin( is forbidden\nconst char* s = "pow(";\nint a = asin2(1);\n',
            "server/world/deep/tick.cpp": '#include "protocol/codec/messages.hpp"\n  #  include "server/world/world.hpp"\n',
            "server/net/process.cpp": "#include <sys/types.h>\n#include <unistd.h>\n#include <boost/asio.hpp>\n",
            "server/main.cpp": '#include "server/net/session.hpp"\n',
            "tests/unit/both.cpp": '#include "server/world/world.hpp"\n#include "client/net/link.hpp"\n#include <random>\n',
        }
        self.assertEqual(self.violations(good), [])

    def test_against_the_arrow(self):
        self.assert_one({"protocol/model/sea.hpp": '#include <vector>\n\n#include "server/world/world.hpp"\n'},
                        "protocol/model/sea.hpp:3", "protocol/model may not include", "protocol/units")

    def test_server_and_client(self):
        self.assert_one({"client/net/a.cpp": '#include "server/net/link.hpp"\n'}, "client/net/a.cpp:1", "may not include")
        self.assert_one({"server/net/a.cpp": '\n#include "client/net/link.hpp"\n'}, "server/net/a.cpp:2", "may not include")

    def test_only_the_named_file_of_a_folder(self):
        self.assert_one({"server/world/a.cpp": '#include "protocol/codec/codec.hpp"\n'}, "server/world/a.cpp:1",
                        "server/world may not include", "protocol/codec/messages.hpp")

    def test_libraries(self):
        self.assert_one({"server/world/a.hpp": "// sockets\n#include <boost/asio/ip/tcp.hpp>\n"}, "server/world/a.hpp:2",
                        "server/net, client/net only")
        self.assert_one({"server/net/other.cpp": "#include <unistd.h>\n"}, "server/net/other.cpp:1",
                        "server/net/process.cpp only")
        self.assert_one({"server/net/a.cpp": '#include "messages_generated.h"\n'}, "server/net/a.cpp:1", "no file yet")
        self.assert_one({"protocol/model/a.cpp": "#include <random>\n"}, "protocol/model/a.cpp:1", "tests only")
        self.assert_one({"tests/unit/a.cpp": "#include <unknown/thing.hpp>\n"}, "tests/unit/a.cpp:1", "[libraries]")
        self.assert_one({"tests/unit/a.cpp": "#include <math.h>\n"}, "tests/unit/a.cpp:1", "[libraries]")

    def test_forms_of_include(self):
        self.assert_one({"protocol/model/a.cpp": '#include "a.hpp"\n'}, "protocol/model/a.cpp:1", "rooted")
        self.assert_one({"protocol/model/a.cpp": '#include "../units/a.hpp"\n'}, "protocol/model/a.cpp:1", "rooted")
        self.assert_one({"protocol/model/a.cpp": "#include <protocol/units/a.hpp>\n"}, "protocol/model/a.cpp:1", "is ours")
        self.assert_one({"protocol/model/a.cpp": "#include HEADER\n"}, "protocol/model/a.cpp:1", "name the file")

    def test_new_folders_have_to_be_entered(self):
        self.assert_one({"server/extra/a.cpp": "int a;\n"}, "server/extra/a.cpp:1", "no folder that covers")
        self.assert_one({"server/main.cpp": '#include "server/extra/a.hpp"\n'}, "server/main.cpp:1", "does not name")

    def test_words(self):
        self.assert_one({"server/world/a.cpp": "/* sin(\n */\nfloat a = std::sinf(1);\n"}, "server/world/a.cpp:3",
                        "std::sinf(")
        self.assert_one({"protocol/model/a.cpp": "int big = 1'000'000; float a = pow(1, 2);\n"}, "protocol/model/a.cpp:1",
                        "pow(")
        self.assertEqual(self.violations({"server/net/a.cpp": "float a = std::sin(1);\n"}), [])

    def test_sizes_names_and_readmes(self):
        self.assertEqual(self.violations({"server/net/a.cpp": "int a;\n" * 600}), [])
        self.assert_one({"server/net/a.cpp": "int a;\n" * 601}, "server/net/a.cpp:601", "at most 600")
        self.assert_one({"server/net/string_utils.hpp": ""}, "server/net/string_utils.hpp:1", "names nothing")
        self.assert_one({"server/net/common/a.hpp": ""}, "server/net/common/a.hpp:1", "'common'")
        self.assertEqual(self.violations({"server/net/uncommon.hpp": ""}), [])
        self.assert_one({"server/net/README.md": "line\n" * 21}, "server/net/README.md:21", "at most 20")
        self.assert_one({"server/net/a.hpp": ""}, "server/net/README.md:1", "missing", readmes=False)

    def test_tables_that_cannot_be_read(self):
        for table, place in (("[colours]\n", ":1: unknown section"), ("a : b\n", ":1: want a section"),
                             ("[folders]\nserver/net\n", ":2: want"), ("[folders]\na :\na :\n", ":3: a is already"),
                             ("[libraries]\nx.h :\n", ":2: name folders"), ("[words]\n( : a\n", ":2: not a regular")):
            with self.assertRaises(layering.TableError) as caught:
                self.violations({}, table=table)
            self.assertIn(place, str(caught.exception))

    def test_the_command(self):
        with tempfile.TemporaryDirectory() as folder, contextlib.redirect_stdout(io.StringIO()) as out:
            (pathlib.Path(folder) / "server/net").mkdir(parents=True)
            (pathlib.Path(folder) / "server/net/README.md").write_text("**Knows**\n", encoding="utf-8")
            (pathlib.Path(folder) / "server/net/a.cpp").write_text('#include "client/gpu/a.hpp"\n', encoding="utf-8")
            self.assertEqual(layering.main(["--root", folder]), 1)
            (pathlib.Path(folder) / "server/net/a.cpp").write_text("#include <vector>\n", encoding="utf-8")
            self.assertEqual(layering.main(["--root", folder]), 0)
        self.assertIn("server/net/a.cpp:1: server/net may not include", out.getvalue())
        self.assertIn("layering: 1 files, 1 includes, 0 violations", out.getvalue())


if __name__ == "__main__":
    unittest.main()
