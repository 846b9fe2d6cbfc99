"""How much of the model the golden vectors hold on to: changes the second client's sea in one place at a time (an operator, a
constant, a comparison, a sign) and counts the changes that no golden line notices.

    mutation.py [--files sea.txt edges.txt fields.txt] [--module sea_wake] [--jobs 2] [--list]

Takes minutes; it is no test. Exit status 0, the survivors on standard output."""
import argparse
import ast
import multiprocessing
import pathlib
import random
import signal
import sys
import types

HERE = pathlib.Path(__file__).resolve().parent
GOLDEN = HERE.parents[1] / "golden"
ORDER = ("binary32", "hashing", "sea_features", "sea_noise", "sea_records", "sea_wake", "sea", "clock", "golden_sea", "golden_check")
MUTATED = ("sea_features", "sea_noise", "sea_records", "sea_wake", "sea")
PATIENCE_S = 120

SWAPS = {ast.Add: ast.Sub, ast.Sub: ast.Add, ast.Mult: ast.Add, ast.Div: ast.Mult, ast.FloorDiv: ast.Mult, ast.LShift: ast.RShift,
         ast.RShift: ast.LShift, ast.BitAnd: ast.BitOr, ast.BitXor: ast.BitAnd, ast.Mod: ast.FloorDiv, ast.Pow: ast.Mult}
TURNS = {ast.Lt: ast.LtE, ast.LtE: ast.Lt, ast.Gt: ast.GtE, ast.GtE: ast.Gt, ast.Eq: ast.NotEq, ast.NotEq: ast.Eq}
CALLS = {"min": "max", "max": "min"}


def changes(node):
    """(what, how to do it) for each way to change one node."""
    if isinstance(node, ast.BinOp) and type(node.op) in SWAPS:
        other = SWAPS[type(node.op)]
        yield f"{type(node.op).__name__} to {other.__name__}", lambda: setattr(node, "op", other())
    elif isinstance(node, ast.UnaryOp) and isinstance(node.op, ast.USub):
        yield "minus dropped", lambda: setattr(node, "op", ast.UAdd())
    elif isinstance(node, ast.Compare) and len(node.ops) == 1 and type(node.ops[0]) in TURNS:
        other = TURNS[type(node.ops[0])]
        yield f"{type(node.ops[0]).__name__} to {other.__name__}", lambda: setattr(node, "ops", [other()])
    elif isinstance(node, ast.BoolOp):
        other = ast.And if isinstance(node.op, ast.Or) else ast.Or
        yield f"to {other.__name__}", lambda: setattr(node, "op", other())
    elif isinstance(node, ast.IfExp):
        yield "condition always true", lambda: setattr(node, "test", ast.Constant(True))
        yield "condition always false", lambda: setattr(node, "test", ast.Constant(False))
    elif isinstance(node, ast.If):
        yield "branch never taken", lambda: setattr(node, "test", ast.Constant(False))
    elif isinstance(node, ast.Constant) and type(node.value) in (int, float):
        yield f"{node.value} plus 1", lambda: setattr(node, "value", node.value + 1)
    elif isinstance(node, ast.Call) and isinstance(node.func, ast.Name) and node.func.id in CALLS:
        yield f"{node.func.id} to {CALLS[node.func.id]}", lambda: setattr(node.func, "id", CALLS[node.func.id])


def parsed(module):
    return ast.parse((HERE / f"{module}.py").read_text(encoding="utf-8"))


def mutants(module):
    """(index, line, what) of every change of a module's functions and constants."""
    return [(index, getattr(node, "lineno", 0), what) for index, (node, what, _) in enumerate(all_changes(parsed(module)))]


def all_changes(tree):
    skipped = {id(inner) for node in ast.walk(tree) if isinstance(node, ast.ClassDef) and any(
        isinstance(base, ast.Name) and base.id == "NamedTuple" for base in node.bases) for inner in ast.walk(node)}
    for node in ast.walk(tree):
        if id(node) not in skipped:
            for what, change in changes(node):
                yield node, what, change


def load(changed=None, index=None):
    """All modules anew, one of them changed; the last one."""
    for name in ORDER:
        tree = parsed(name)
        if name == changed:
            for at, (_, _, change) in enumerate(all_changes(tree)):
                if at == index:
                    change()
                    break
            ast.fix_missing_locations(tree)
        module = types.ModuleType(name)
        module.__file__ = str(HERE / f"{name}.py")
        sys.modules[name] = module
        exec(compile(tree, f"{name}.py", "exec"), module.__dict__)
    return sys.modules[ORDER[-1]]


def survives(job):
    """Whether no golden line notices the change."""
    (module, index), files = job

    def stop(*_):
        raise TimeoutError

    signal.signal(signal.SIGALRM, stop)
    signal.alarm(PATIENCE_S)
    try:
        check = load(module, index)
        for file in files:
            golden = check.GoldenSea(GOLDEN / file)
            lines = [(kind, words) for kind, all_words in golden.lines.items() for words in all_words]
            random.Random(7).shuffle(lines)
            lines.sort(key=lambda line: line[0] == "hash")  # each is thousands of samples
            for kind, words in lines:
                if check.answer(golden, kind, words) != words[check.ARGUMENTS[kind]:]:
                    return False
    except Exception:  # whatever a change breaks is noticed
        return False
    finally:
        signal.alarm(0)
    return True


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--files", nargs="+", default=["sea.txt", "edges.txt", "fields.txt"])
    parser.add_argument("--module", choices=MUTATED, action="append")
    parser.add_argument("--jobs", type=int, default=2)
    parser.add_argument("--list", action="store_true", help="only list the changes")
    options = parser.parse_args()
    sys.path.insert(0, str(HERE))
    all_mutants = [(module, *mutant) for module in options.module or MUTATED for mutant in mutants(module)]
    if options.list:
        for module, _, line, what in all_mutants:
            print(f"{module}.py:{line}: {what}")
        return
    if not survives(((None, 0), options.files)):
        sys.exit("the unchanged model does not reproduce the golden lines")
    alive = 0
    with multiprocessing.Pool(options.jobs, maxtasksperchild=20) as pool:
        jobs = (((module, index), options.files) for module, index, _, _ in all_mutants)
        for (module, _, line, what), survived in zip(all_mutants, pool.imap(survives, jobs)):
            if survived:
                alive += 1
                print(f"{module}.py:{line}: {what}", flush=True)
    print(f"{alive} of {len(all_mutants)} changes are noticed by no line of {', '.join(options.files)}")


if __name__ == "__main__":
    main()
