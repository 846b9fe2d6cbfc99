#!/usr/bin/env python3
"""Whether the simulation can fail: plants one fault after the other and wants a seed that catches it.

usage: planted_faults.py [BUILD] [--seeds N] [--only WORD]
Of each fault one source is compiled anew (its copy, with the build's own command) and linked before the libraries of
BUILD (default build/release), where trochoid-simulation has been built. The tree stays as it is. Exit 0: all are caught; 1: one is
not; 2: a fault does not fit the sources any more.
"""
import argparse
import json
import pathlib
import shlex
import subprocess
import sys
import tempfile

# name, source, what stands there, what takes its place
FAULTS = [
    ("pieces of a cut result stay", "client/store/client_store.cpp",
     "        state_ = *snapshot_->interest;\n", ""),
    ("the newest view is not told after the hello", "client/app/session_link.cpp",
     "    view_changed();\n    regions_changed();\n    log_position_", "    regions_changed();\n    log_position_"),
    ("the newest regions are not told after the hello", "client/app/session_link.cpp",
     "    view_changed();\n    regions_changed();\n    log_position_", "    view_changed();\n    log_position_"),
    ("the client's view timer is set once", "client/app/session_link.cpp", "            view_timer_ = false;\n", ""),
    ("tries without a back-off", "client/app/session_link.cpp", "first_pause_ms << std::min(failures, 10U)", "first_pause_ms"),
    ("a result is acknowledged before it is whole", "client/store/client_store.cpp",
     "    if (!delta.last) return std::optional<Ack>{};\n    state_hash_",
     "    if (!delta.last) return std::optional<Ack>(Ack{delta.result, hash_of(state_), 0, {}});\n    state_hash_"),
    ("the client's base number is wrong after a resumption", "client/store/client_store.cpp",
     "applied_ = resumed ? 1 : 0;", "applied_ = 0;"),
    ("land that was touched keeps its old field", "client/store/client_store.cpp",
     "kept != old.end() && !touched.contains(id)", "kept != old.end()"),
    ("land blocks are lost when a session goes on", "client/store/client_store.cpp",
     "        state_hash_ = whole_hash_;\n", "        state_hash_ = whole_hash_;\n        state_.blocks.clear();\n"),
    ("a goodbye is passed by", "client/net/connection.cpp",
     "        return finish(*goodbye, CloseCause::server_goodbye);", "        return;"),
    ("a new epoch is passed by", "client/store/clock_estimator.cpp",
     "    clock_ = reply.clock;\n    known_ = true;\n    take(reply", "    known_ = true;\n    take(reply"),
    ("the server keeps its base after a resync", "server/net/state_lane.cpp",
     "    base_ = std::make_shared<const InterestState>();\n    base_hash_ = hash_of(*base_);\n    base_result_", "    base_result_"),
    ("credit is not renewed", "server/net/state_lane.cpp",
     "    acknowledged_bytes_ = std::max(acknowledged_bytes_, mark.bytes_until);\n", ""),
    ("a difference told is answered by nothing", "server/net/session_input.cpp",
     "    state_.resync();\n    sea_news_ = true;\n}\n\nvoid Session::handle(const Goodbye", "}\n\nvoid Session::handle(const Goodbye"),
    ("the clock is asked no more after the first eight times", "client/app/session_link.cpp",
     "    loop_.after(pause, [this, row, done]", "    if (done + 1 < clock_burst) loop_.after(pause, [this, row, done]"),
    ("a key is not renewed when its span runs out", "server/net/session.cpp",
     "    if (now_us >= refresh_at_us_) {", "    if (false) {"),
    ("a claim of another state is believed", "server/app/sea_service.cpp",
     "hash_of(*held.state) == claim.state_hash ? ResumeVerdict::resumed : ResumeVerdict::other_state", "ResumeVerdict::resumed"),
    ("two nodes number their events alike", "server/app/sea_authority.cpp",
     "(uint64_t{node_} << event_number_bits) | next_event_++", "next_event_++"),
    ("promises under the old clock are forgotten", "server/app/sea_authority_nodes.cpp",
     "    if (node_ == 0) return;\n    const SeaClock& old", "    if (node_ != 0) return;\n    const SeaClock& old"),
    ("a node promises two leads", "server/app/sea_authority_nodes.cpp",
     "lead_in_sea_time(clock, lead_ms_));\n    if (news", "2 * lead_in_sea_time(clock, lead_ms_));\n    if (news"),
]


def linked_with(build, command, thing):
    """The link command, with another object before all and another program."""
    words = shlex.split(command)
    words = words[words.index("&&") + 1:]
    words = words[:len(words) - words[::-1].index("&&") - 1] if "&&" in words else words
    out = words.index("-o")
    return words[:1] + [thing + ".o"] + words[1:out + 1] + [thing] + words[out + 2:]


def plant(root, build, commands, link, fault, folder):
    name, source, old, new = fault
    text = (root / source).read_text()
    if text.count(old) != 1:
        sys.exit(print(f"'{name}' does not fit {source}: it has {text.count(old)} such places", file=sys.stderr) or 2)
    thing = str(folder / "faulty")
    (folder / "faulty.cpp").write_text(text.replace(old, new))
    compile_it = next(c for c in commands if c["file"] == str(root / source))
    words = shlex.split(compile_it["command"])
    words[words.index("-o") + 1] = thing + ".o"
    words[words.index(str(root / source))] = thing + ".cpp"
    words = [w for w in words if w not in ("-Werror", "-Wall", "-Wextra")]
    subprocess.run(words + ["-w"], cwd=compile_it["directory"], check=True)
    subprocess.run(linked_with(build, link, thing), cwd=build, check=True)
    return thing


def main():
    root = pathlib.Path(__file__).resolve().parents[2]
    options = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    options.add_argument("build", nargs="?", default=root / "build/release", type=pathlib.Path)
    options.add_argument("--seeds", default=2000, type=int)
    options.add_argument("--only", default="", help="faults whose name has this in it")
    asked = options.parse_args()
    build = asked.build.resolve()
    commands = json.loads((build / "compile_commands.json").read_text())
    link = subprocess.run(["ninja", "-C", build, "-t", "commands", "trochoid-simulation"], check=True, text=True,
                          capture_output=True).stdout.strip().splitlines()[-1]
    missed = 0
    for fault in (f for f in FAULTS if asked.only in f[0]):
        with tempfile.TemporaryDirectory() as folder:
            program = plant(root, build, commands, link, fault, pathlib.Path(folder))
            lives = subprocess.run([program, "--seeds", str(asked.seeds), "--first"], text=True, capture_output=True,
                                   timeout=600)
        told = [line for line in lives.stderr.splitlines() if line.startswith("simulation: ")]
        missed += 0 if lives.returncode == 1 and told else 1
        print(f"{'caught' if lives.returncode == 1 and told else 'MISSED'}: {fault[0]}"
              f"{': ' + told[0][len('simulation: '):] if told else ''}", flush=True)
    print(f"{missed} of {len(FAULTS)} faults are not caught" if missed else "all are caught")
    return 1 if missed else 0


if __name__ == "__main__":
    sys.exit(main())
