#!/usr/bin/env python3
"""Which functions hold the code that one cycle touches: touched_code.py PROGRAM SCENE [ROWS].

PROGRAM is the study `cold`, compiled for x86-64-v3 with `-g` and linked with `-no-pie`; SCENE is 0 (the README's) or 1 (the main
job's). Callgrind counts every instruction of 1000 and of 3000 cycles: what the difference holds runs in a cycle.
addr2line says into which functions an instruction was inlined: its bytes count for each of them, so that rows overlap.
Copies: how often a function was inlined; a second copy could be a call.
"""
import bisect
import collections
import os
import re
import subprocess
import sys
import tempfile

FEW, MANY = 1000, 3000


def counts(program, scene, cycles):
    """How often each address ran. The line after `calls=` is the cost of the callee."""
    with tempfile.TemporaryDirectory() as folder:
        out = os.path.join(folder, "callgrind.out")
        subprocess.run(["valgrind", "--tool=callgrind", "--dump-instr=yes", "--compress-pos=no",
                        "--compress-strings=no", f"--callgrind-out-file={out}", program, "cycles", scene,
                        str(cycles)], check=True, capture_output=True)
        ran, call = collections.Counter(), False
        for line in open(out):
            if line.startswith("0x") and not call:
                words = line.split()
                ran[int(words[0], 16)] += int(words[-1])
            call = line.startswith("calls=") or (call and not line.startswith("0x"))
        return ran


def without(text, opening, closing):
    """`text` without what stands in brackets."""
    out, depth = "", 0
    for c in text:
        depth += c == opening
        if depth == 0:
            out += c
        depth -= c == closing and depth > 0
    return out


def short(name):
    """The function's own name, without arguments and return type."""
    for sign, word in (("<=>", "-order"), ("<=", "-le"), (">=", "-ge"), ("<<", "-shl"), (">>", "-shr"),
                       ("->", "-arrow"), ("<", "-lt"), (">", "-gt"), ("()", "-call")):
        name = name.replace("operator" + sign, "operator" + word)
    name = without(without(name.replace("(anonymous namespace)", ""), "<", ">"), "(", ")")
    name = re.sub(r"\[.*?\]| const\b|skinctl::|v\d+_\d+_\w+?::", "", name).strip()
    return name.split(" ")[-1] or "?"


def main():
    program, scene = sys.argv[1:3]
    rows = int(sys.argv[3]) if len(sys.argv) > 3 else 40
    few, many = counts(program, scene, FEW), counts(program, scene, MANY)
    cycle = {at: (n - few[at]) / (MANY - FEW) for at, n in many.items()}
    runs = {at: n for at, n in cycle.items() if n >= 0.5}
    text = subprocess.run(["objdump", "-d", "-w", "--no-show-raw-insn", program], check=True, capture_output=True,
                          text=True).stdout
    places = sorted(int(m, 16) for m in re.findall(r"^\s+([0-9a-f]+):", text, re.M))
    own = [at for at in runs if places[0] <= at < places[-1]]
    length = {at: places[bisect.bisect_right(places, at)] - at for at in own}
    print(f"{sum(cycle.values()):.0f} instructions a cycle, {len({at // 64 for at in runs}) / 16:.1f} KB in lines "
          f"of 64 bytes, {sum(length.values()) / 1024:.1f} KB of them executed\n")
    names = subprocess.run(["addr2line", "-i", "-f", "-C", "-a", "-e", program], check=True, capture_output=True,
                           input="\n".join(map(hex, own)), text=True).stdout.splitlines()
    size, ran, copies = collections.Counter(), collections.Counter(), collections.defaultdict(set)
    at, stack = None, []

    def add():
        functions = [short(f) for f, _ in stack]
        for name in set(functions):
            outermost = len(functions) - functions[::-1].index(name)
            size[name] += length[at]
            ran[name] += runs[at]
            copies[name].add(tuple(line for _, line in stack[outermost:]))

    lines = iter(names)
    for line in lines:
        if line.startswith("0x"):
            if at is not None:
                add()
            at, stack = int(line, 16), []
        else:
            stack.append((line, next(lines)))
    add()
    print("| function | bytes | instructions | copies |\n|---|---|---|---|")
    for name, n in size.most_common(rows):
        print(f"| `{name}` | {n} | {ran[name]:.0f} | {len(copies[name])} |")


if __name__ == "__main__":
    main()
