"""The table of benchmarks. To add one: a line here, and a program that keeps the contract of README.md."""
import dataclasses


@dataclasses.dataclass(frozen=True)
class Bench:
    title: str
    program: str  # a CMake target that gives <build>/bin/NAME, or a script of this folder (NAME.py)
    bar: str
    arguments: tuple = ()
    quick: tuple = ("--quick",)
    also: tuple = ()  # other targets that must be built


BENCHES = {
    "P1": Bench("grid evaluation, displacement + normal, 256^2 points x 16 trains, one core", "grid.py",
                ">= 40x double std::sin/cos with AVX-512, >= 24x AVX2; >= 75 % of the kernel's bound; within 10 % of native",
                also=("trochoid-bench-grid",)),
    "P2": Bench("paper A's scenarios 1 and 2: all grids, effects on and off, culled box by box", "trochoid-bench-scenarios",
                "linear in points; culled box < 1 %, half in view <= 60 %; 1024^2 x 6 with normals <= 6 ms on 2 AVX2 cores"),
    "P3": Bench("batched authoritative point queries, 60 trains, one core", "trochoid-bench-queries",
                "<= 3 ns AVX-512, <= 5 ns AVX2 per train and query; <= 1.6x with fields; 1000 x 60 <= 0.18 ms"),
    "P4": Bench("land traces of 1024 rays x 1024 steps x 8 bands, one core; a moved breakwater", "trochoid-bench-land",
                "straight <= 50 ms, eikonal <= 3x that; a moved breakwater costs less than a whole trace"),
    "P5": Bench("what a client costs on the wire: a static camera, one at 30 m/s over 512 patches, a storm of 100 new trains, at sea and off a "
                "coast; both directions, 52 bytes a segment, no TLS", "trochoid-bench-wire",
                "<= 2 kbit/s; p95 of seconds <= 64 kbit/s; <= 16 KiB, land blocks apart; <= 28 bytes a train", also=("trochoid-server",)),
    "P6": Bench("from the TCP connection to every patch of the first view, round trips of 0, 50 and 200 ms, with slow start",
                "trochoid-bench-round-trips", "<= 2 round trips + 50 ms raw, 3 in TLS, 4 as a WebSocket in TLS", also=("trochoid-server",)),
    "P8": Bench("a picture of 1280 x 720 with 250,000 triangles and 60 trains by every mesher, passes, qualities; coherent tessellation",
                "joined.py", ">= 5 fps at the default quality; <= 4 ms on H100 or H200, <= 1 ms on other cards; coherent tessellation < 1.0x of "
                "that from the base on a slow flight, <= 1.15x after a cut",
                arguments=("trochoid-bench-frame", "trochoid-bench-coherent"), also=("trochoid-bench-frame", "trochoid-bench-coherent")),
    "P9": Bench("the papers' own tables on the GPU, theirs beside ours", "trochoid-bench-papers", "reproduced as tables and plots"),
    "A10": Bench("what a box of trains costs by the share of it that is in view, by every mesher", "clipping.py",
                 "trains evaluated <= 0.8 with half of it in view, <= 0.5 with the least", also=("clipping_cost",)),
    "R2": Bench("vertices of every mesher against the CPU: 10 m seas, now and in ten years, here and 9000 km away", "trochoid-bench-twin",
                "phases equal; displacement <= 0.1 mm"),
    "R3": Bench("every parser fuzzed, and hostile buffers that the FlatBuffers verifier accepts", "fuzzing.py",
                ">= 8 parsers, nothing breaks one; >= 5,000 hostile vectors, all rejected with the expected code",
                also=("trochoid-bench-hostile",)),
    "R7": Bench("good clients beside slow hellos, floods, garbage, oversize frames, bad and replayed tokens", "trochoid-bench-abuse",
                "their p99 within 10 %; <= 4 KiB of a peer's size before its login; every disconnect has a code",
                also=("trochoid-server",)),
    "R8": Bench("the conformance kit against programs that break one requirement each: servers and clients behind a relay",
                "../conformance/mutants/mutants.py", "all; those that no session can break are named",
                also=("trochoid-mutant", "trochoid-conformance", "trochoid-server", "trochoid-ctl", "trochoid-probe")),
    "B8": Bench("long waves on a coarser grid, interpolated: where it pays, and its error bound", "trochoid-bench-coarse",
                "the bound holds at every point; the recommended ratio is faster"),
    "spectra": Bench("computed seas against their spectra and published heights and periods: 5 winds x 5 fetches x 3 spectra",
                     "trochoid-bench-spectra",
                     "Hs within 2 % (sampled), Tz 4 %, Tp 3 %; the spectra within 1 % of what was published"),
}
