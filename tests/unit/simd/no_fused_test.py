"""No product of the fast path is fused with a sum (R-201): looks for such instructions in the compiled library."""
import re
import subprocess
import sys

FUSED = re.compile(r"\s(vf(n?)m(add|sub)\w*|fmadd|fmsub|fnmadd|fnmsub|fmla|fmls|xvmadd\w*|vfm[as]\w*)\s")


def main():
    library = sys.argv[1]
    code = subprocess.run(["objdump", "-d", "--no-show-raw-insn", library], capture_output=True, text=True, check=True).stdout
    products = len(re.findall(r"mulps|mulss|fmul", code))
    if products < 100:
        print(f"only {products} products in {library}: is this the right file?")
        return 1
    fused = [line.strip() for line in code.splitlines() if FUSED.search(line)]
    for line in fused[:10]:
        print(f"fused: {line}")
    print(f"{products} products, {len(fused)} fused with a sum")
    return 1 if fused else 0


if __name__ == "__main__":
    sys.exit(main())
