"""Runs tests of this folder by name: suite.py golden_sea wire … Exit status 77: skipped, with the reason."""
import importlib.util
import shutil
import sys
import unittest

SKIPPED = 77


def missing():
    """What this machine lacks, or nothing."""
    if importlib.util.find_spec("flatbuffers") is None:
        return "python3-flatbuffers is missing (apt-get install python3-flatbuffers; CMake has to find Debian's /usr/bin/python3)"
    if shutil.which("flatc") is None:
        return "flatc is missing (apt-get install flatbuffers-compiler)"
    return ""


def main():
    reason = missing()
    if reason:
        print(f"SKIPPED: {reason}")
        return SKIPPED
    names = [f"{name}_test" for name in sys.argv[1:]]
    suite = unittest.defaultTestLoader.loadTestsFromNames(names)
    result = unittest.TextTestRunner(verbosity=2).run(suite)
    return 0 if result.wasSuccessful() and result.testsRun else 1


if __name__ == "__main__":
    sys.exit(main())
