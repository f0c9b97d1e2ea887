#!/usr/bin/env python3
"""Pads of other makers, played by Python, and a receiver in Python at the other end of skin_bridge.

pad_peers.py PATH/skin_bridge    an AnySkin, a TF-Luna, a PapillArray, a home-made pad at pseudo terminals (struct), XELA's server
                                  (websockets, json)
"""
import asyncio
import json
import os
import platform
import socket
import struct
import subprocess
import sys
import time
import tty

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "../../support"))
from peer import Peer, skip  # noqa: E402

PROGRAM = sys.argv[1]
peer = Peer("struct of Python %s" % platform.python_version())


def check(holds, what):
    peer.require(holds, what)


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


def tf_luna():
    readings = [("near", 0, 1), ("distance", 0, 655.35), ("strength", 0, 65534), ("temperature", -256, 8000)]
    kind = fingerprint("tf-luna", readings)
    near, far = os.openpty()
    tty.setraw(far)
    here = receiver()
    job = bridge("tf-luna:" + os.ttyname(far), here, "--cell", "7", "--seconds", "2")
    time.sleep(0.5)  # it empties the line when it opens it
    sent = []
    os.write(near, b"\x59\x01")
    for k in range(100):
        distance, strength = 20 + k, 65535 if k == 50 else 300 + k
        frame = b"YY" + struct.pack("<HHH", distance, strength, (256 + 30) * 8 + k)
        frame += bytes([sum(frame) & 0xff])
        os.write(near, frame[:k % 9])  # cut anywhere
        os.write(near, frame[k % 9:])
        time.sleep(0.01)
        if k != 50:
            sent.append((distance, strength, 30 + k / 8))
    got = []
    while len(got) < len(sent):
        for cell, _, measured, unrest, x in samples(here.recv(2048), kind, 4)[1]:
            check(cell == 7 and measured == 1 and unrest == 65535, "cell 7, measured once")
            distance, strength, warm = sent[len(got)]
            expected = (min(1, max(0, (100 - distance) / 80)), distance / 100, strength, warm)
            check(all(abs(a - b) < 1e-5 for a, b in zip(x[:2], expected)) and tuple(x[2:]) == expected[2:],
                  "frame %d: %r, not %r" % (len(got), x, expected))
            got.append(x)
    said, _ = job.communicate()
    check(job.returncode == 0 and "100 messages, 99 samples, 1 refused" in said and "blinded in 1 frames" in said
          and "2 bytes" in said, said)
    print("TF-Luna: %d frames, written by struct and a pseudo terminal, came through" % len(got))
    os.close(near)
    os.close(far)


def papill_array():
    readings = [("%s %s" % (what, axis), -50, 50) for what in ("force", "deflection") for axis in "xyz"]
    kind = fingerprint("papill-array", readings)
    near, far = os.openpty()
    tty.setraw(far)
    here = receiver()
    job = bridge("papill-array:" + os.ttyname(far), here, "--bias", "--seconds", "2")
    asked = b""
    while not asked.endswith(b"z\n"):
        asked += os.read(near, 16)
    check(asked == b"f500\nz\n", "the rate and the bias are asked for: %r" % asked)

    def offsets(first, sizes):
        return b"".join(struct.pack("<I", first + sum(sizes[:k])) for k in range(len(sizes)))

    pillars = [9, 4]

    def force(k, sensor, pillar, i):
        return 0.25 * i + 0.5 * pillar - 2 * sensor + k / 128

    for k in range(200):
        hub = struct.pack("<IQ", k, 77000000 + 2000 * k)
        sensors = []
        for s, n in enumerate(pillars):
            entries = [struct.pack("<H6f", 2, *[force(k, s, p, i) for i in range(6)]) for p in range(n)]
            sensors.append(struct.pack("<H", n) + offsets(2 + 4 * n, [len(e) for e in entries]) + b"".join(entries))
        block = struct.pack("<H", 2) + offsets(10, [len(s) for s in sensors]) + b"".join(sensors)
        slip = b"\xaa\xbb\xcc\xdd\x55\x66\x77\x88"  # a block that nobody reads, full of marks
        begin = 1 + 3 * 6
        index = struct.pack("<HIHIHI", 1, begin, 3, begin + 12, 7, begin + 12 + len(block))
        data = b"\x04" + index + hub + block + slip
        data += struct.pack("<H", sum(data) & 0xffff)
        packet = b"\x55\x66\x77\x88" + data + b"\xaa\xbb\xcc\xdd"
        if k == 100:
            packet = packet[:60] + packet[61:]  # a byte is lost
        os.write(near, packet[:k])
        os.write(near, packet[k:])
        time.sleep(0.002)
    got = 0
    while got < 199 * 13:
        for cell, _, measured, _, x in samples(here.recv(2048), kind, 6)[1]:
            k, i = divmod(got, 13)
            sensor, pillar = (0, i) if i < 9 else (1, i - 9)
            k += k >= 100
            check(cell == 128 * sensor + pillar and measured == 1, "pillar %d of sensor %d" % (pillar, sensor))
            check(list(x) == [force(k, sensor, pillar, j) for j in range(6)], "forces of packet %d" % k)
            got += 1
    said, _ = job.communicate()
    check(job.returncode == 0 and "199 messages, 2587 samples, 0 refused" in said, said)
    print("PapillArray: %d pillars, written by struct and a pseudo terminal, came through" % got)
    os.close(near)
    os.close(far)


def home_made():
    kind = fingerprint("home-made", [("pressure", 0, 1)])
    near, far = os.openpty()
    tty.setraw(far)
    here = receiver()
    job = bridge("datagrams:" + os.ttyname(far), here, "--seconds", "1.5", "--baud", "921600")
    time.sleep(0.5)
    sent = []
    for k in range(100):
        data = struct.pack("<4sHHIqHHI", b"SKIN", 3, k % 5, k, 10**9 + 10**6 * k, 0, 1, kind)
        data += b"".join(struct.pack("<IqHHf", i, 10**9 + 10**6 * k - 5, 1, 300, i / 8 + k / 1024)
                         for i in range(k % 5))
        sent.append(data)
        os.write(near, data[:k % 20] + (data[k % 20:] if k != 50 else b""))
        time.sleep(0.002)
    del sent[50]
    check([here.recv(2048) for _ in sent] == sent, "99 datagrams as they were written")
    said, _ = job.communicate()
    check(job.returncode == 0 and "99 messages, 200 samples" in said and "10 bytes" in said, said)
    print("a home-made pad: %d datagrams, written by struct and a pseudo terminal, came through" % len(sent))
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
tf_luna()
papill_array()
home_made()
try:
    import websockets
except ImportError:
    skip("python3-websockets")
peer.name += ", websockets %s" % websockets.__version__
xela(websockets)
peer.end()
