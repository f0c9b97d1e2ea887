#!/usr/bin/env python3
"""Loads of a cycle that wait: waiting_loads.py PROGRAM SCENE.

A processor hands a number from a store to a load behind it if one store wrote all that is loaded; a load of what several
stores wrote waits until they have left for the cache, 15 cycles or so. Compilers make such loads: a struct is copied in wider
pieces than it was written in, a loop over two links' wrenches takes numbers of both.

PROGRAM is the study `cold`, compiled for x86-64-v3 with `-g` and linked with `-no-pie`; SCENE is 0 (the README's) or 1 (the main
job's). Lackey traces 20 and 60 cycles; counted is the difference, a cycle: loads of bytes from several stores, one of
them among the 40 before. Valgrind knows no AVX-512: there pieces are wider still, and such loads more.
"""
import collections
import os
import subprocess
import sys

FEW, MANY, NEAR = 20, 60, 40


def waiting(program, scene, cycles):
    """How often each load waits: (address of the instruction, of the last store that it waits for, bytes)."""
    read, write = os.pipe()
    run = subprocess.Popen(["valgrind", "--tool=lackey", "--trace-mem=yes", f"--log-fd={write}", program, "cycles", scene,
                            str(cycles)], stdout=subprocess.DEVNULL, pass_fds=[write])
    os.close(write)
    wrote, at, stores, here = {}, [0], 0, 0
    found = collections.Counter()
    for line in os.fdopen(read, errors="replace"):
        kind = line[:2].strip()
        if kind not in ("I", "L", "S", "M") or line[2] != " ":
            continue
        address, size = line[3:].split(",")
        address, size = int(address, 16), int(size)
        if kind == "I":
            here = address
            continue
        if kind in "LM":
            by = {wrote.get(a, 0) for a in range(address, address + size)}
            last = max(by)
            if len(by) > 1 and last > 0 and stores - last < NEAR:
                found[here, at[last], size] += 1
        if kind in "SM":
            stores += 1
            at.append(here)
            for a in range(address, address + size):
                wrote[a] = stores
    if run.wait() != 0:
        sys.exit("waiting_loads: the program failed")
    return found


def place(program, address):
    """The source lines of an instruction, innermost first."""
    out = subprocess.run(["addr2line", "-i", "-s", "-e", program, hex(address)], capture_output=True, text=True)
    return " < ".join(line.split(" ")[0] for line in out.stdout.split("\n")[:5] if line)


def main():
    if len(sys.argv) != 3:
        sys.exit(__doc__)
    program, scene = sys.argv[1:]
    few, many = waiting(program, scene, FEW), waiting(program, scene, MANY)
    rows = sorted(((n - few[key]) / (MANY - FEW), key) for key, n in many.items() if n > few[key])
    print(f"{sum(n for n, _ in rows):.1f} loads a cycle wait for stores of their parts")
    for n, (load, store, size) in reversed(rows):
        print(f"{n:5.1f}  {size} bytes at {place(program, load)}\n         stored at {place(program, store)}")


if __name__ == "__main__":
    main()
