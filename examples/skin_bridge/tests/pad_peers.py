#!/usr/bin/env python3
"""Pads of other makers, played by Python, and a receiver in Python at the other end of skin_bridge.

pad_peers.py PATH/skin_bridge    an AnySkin at a pseudo terminal (struct), XELA's server (websockets, json)
"""
import asyncio
import json
import os
import socket
import struct
import subprocess
import sys
import time
import tty

PROGRAM = sys.argv[1]


def check(holds, what):
    if not holds:
        print("failed:", what)
        sys.exit(1)


def fingerprint(name, readings):
    """FNV-1a as PROTOCOL.md defines it."""
    h = 2166136261

    def mix(data):
        nonlocal h
        for byte in data:
            h = (h ^ byte) * 16777619 & 0xFFFFFFFF

    mix(name.encode() + b"\xff")
    for reading, low, high in readings:
        mix(reading.encode() + b"\xff" + struct.pack("<ff", low, high))
    return h


def receiver():
    here = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
    here.bind(("127.0.0.1", 0))
    here.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, 1 << 20)
    here.settimeout(5)
    return here


def bridge(source, here, *more):
    return subprocess.Popen([PROGRAM, "-q", "--from", source, "--to", "udp:127.0.0.1:%d" % here.getsockname()[1],
                             *more], stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)


def samples(datagram, kind, numbers):
    """Of an open datagram of version 3: (cell, time, measured, unrest, readings)."""
    magic, version, count, sequence, sent, flags, R, print_ = struct.unpack_from("<4sHHIqHHI", datagram)
    check((magic, version, flags, R, print_) == (b"SKIN", 3, 0, numbers, kind),
          "a header of this kind: %r" % ((magic, version, flags, R, hex(print_), hex(kind)),))
    check(len(datagram) == 28 + count * (16 + 4 * R), "a length of %d for %d samples" % (len(datagram), count))
    out = []
    for k in range(count):
        s = struct.unpack_from("<IqHH%df" % R, datagram, 28 + k * (16 + 4 * R))
        check(0 <= sent - s[1] < 10**9, "a stamp at most 1 s before the sending")
        out.append((s[0], s[1], s[2], s[3], s[4:]))
    return sequence, out


def any_skin():
    readings = [("temperature", -50, 150), ("field x", -10000, 10000), ("field y", -10000, 10000),
                ("field z", -10000, 10000)] * 5
    kind = fingerprint("anyskin-5", readings)
    near, far = os.openpty()
    tty.setraw(far)
    here = receiver()
    job = bridge("any-skin:" + os.ttyname(far), here, "--cell", "7", "--seconds", "2")
    time.sleep(0.5)  # it empties the line when it opens it
    sent = []
    os.write(near, b"\x00\x01\r\n")
    for k in range(150):
        packet = [24 + 0.125 * k if i % 4 == 0 else -300 + 16 * i + 0.25 * k for i in range(20)]
        sent.append(packet)
        data = struct.pack("<20f", *packet) + b"\r\n"
        os.write(near, data[:k % 82])  # cut anywhere
        if k == 100:
            os.write(near, b"?")  # and once damaged
        os.write(near, data[k % 82:])
        time.sleep(0.005)
    del sent[100]
    got, stamps = [], []
    while len(got) < len(sent):
        for cell, stamp, measured, unrest, x in samples(here.recv(2048), kind, 20)[1]:
            check(cell == 7 and measured == 1, "cell 7, measured once")
            check(unrest == 65535 if not got else 0 < unrest < 65535, "unrest of a pad whose fields change")
            got.append(list(x))
            stamps.append(stamp)
    said, _ = job.communicate()
    check(got == sent, "149 packets as they were written")
    check(all(a < b for a, b in zip(stamps, stamps[1:])), "stamps that ascend")
    check(job.returncode == 0 and "149 messages, 149 samples, 2 refused" in said and "87 bytes" in said, said)
    print("AnySkin: %d packets, written by struct and a pseudo terminal, came through" % len(got))
    os.close(near)
    os.close(far)


def xela(websockets):
    kind_counts = fingerprint("xela-counts", [("x", 0, 65535), ("y", 0, 65535), ("z", 0, 65535)])
    kind_forces = fingerprint("xela-forces", [("x", -30, 30), ("y", -30, 30), ("z", -30, 30)])

    def count(k, module, taxel, axis):
        return (32768 + 997 * k + 131 * module + 17 * taxel + axis) % 65536

    async def talk(web):
        await web.send(json.dumps({"message": "Welcome", "server": "simulated"}))
        await asyncio.sleep(0.1)
        for k in range(100):
            message = {"message": k, "time": time.time(), "sensors": 2}
            for module in (1, 2):
                taxels = 16 if module == 1 else 24
                message[str(module)] = {
                    "data": ",".join("%04X" % count(k, module, t, a) for t in range(taxels) for a in range(3)),
                    "sensor": str(module), "taxels": taxels, "model": "XR1944" if module == 1 else "XR1946",
                    "calibrated": None if module == 1 else [0.001 * k + 0.25 * t - a for t in range(taxels)
                                                            for a in range(3)]}
            await web.send(json.dumps(message, indent=1 if k % 2 else None))
            if k == 50:
                await web.ping()
            await asyncio.sleep(0.005)
        await web.close()

    async def serve(source, kind, take):
        got = 0
        async with websockets.serve(talk, "127.0.0.1", 0) as server:
            port = server.sockets[0].getsockname()[1]
            here = receiver()
            job = bridge("%s:127.0.0.1:%d" % (source, port), here)
            while job.poll() is None:
                await asyncio.sleep(0.02)
        here.settimeout(0.2)
        said = job.stdout.read()
        last = -1
        try:
            while True:
                sequence, some = samples(here.recv(2048), kind, 3)
                check(sequence == last + 1, "no datagram lost")
                last = sequence
                for s in some:
                    take(s, got)
                    got += 1
        except socket.timeout:
            pass
        check(job.returncode == 1 and "has gone" in said and "100 messages" in said and " 0 refused" in said, said)
        return got

    def take_counts(sample, n):
        k, i = divmod(n, 40)
        module, taxel = (1, i) if i < 16 else (2, i - 16)
        check(sample[0] == 1024 * (module - 1) + taxel, "taxel %d of module %d" % (taxel, module))
        check(list(sample[4]) == [count(k, module, taxel, a) for a in range(3)], "counts of message %d" % k)

    def take_forces(sample, n):
        k, taxel = divmod(n, 24)
        check(sample[0] == 1024 + taxel, "taxel %d of the module that is calibrated" % taxel)
        off = max(abs(x - (0.001 * k + 0.25 * taxel - a)) for a, x in enumerate(sample[4]))
        check(off < 1e-6, "forces of message %d" % k)

    got = asyncio.run(serve("xela", kind_counts, take_counts))
    check(got == 4000, "%d of 4000 taxels by counts" % got)
    print("XELA: %d taxels by counts, told by websockets %s and json, came through" % (got, websockets.__version__))
    got = asyncio.run(serve("xela-forces", kind_forces, take_forces))
    check(got == 2400, "%d of 2400 taxels by forces" % got)
    print("XELA: %d taxels by forces came through" % got)


any_skin()
try:
    import websockets
except ImportError:
    print("skipped: no websockets; sudo apt-get install python3-websockets")
    sys.exit(77)
xela(websockets)
