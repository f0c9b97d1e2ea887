#!/usr/bin/env python3
"""Python's XML (expat, ElementTree) as the other end of KUKA's RSI: it reads what is written here, and what it writes is read.

rsi_peer.py PATH/simulated_arm                a job that leads the simulated controller's first axis by 5 degrees
rsi_peer.py PATH/compliant_arm --controller   a controller around the job, whose tool is pushed once
"""
import os
import pyexpat
import socket
import subprocess
import sys
import time
import xml.etree.ElementTree as xml

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "../../support"))
from peer import Peer  # noqa: E402

AXES = ["A%d" % i for i in range(1, 7)]


def lead(program):
    peer = Peer("expat %s, job" % pyexpat.EXPAT_VERSION.removeprefix("expat_"))
    here = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
    here.bind(("127.0.0.1", 0))
    here.settimeout(10)
    arm = subprocess.Popen([program, "--protocol", "rsi", "--port", str(here.getsockname()[1]), "--speed", "0",
                            "--quiet"])
    read = 0
    try:
        first = last = None
        for k in range(500):
            data, at = here.recvfrom(2048)
            rob = xml.fromstring(data)
            axes = [float(rob.find("AIPos").get(a)) for a in AXES]
            ipoc = int(rob.find("IPOC").text)
            read += rob.tag == "Rob" and rob.get("Type") == "KUKA" and len(data) < 1024 and (last is None or ipoc > last)
            last, first = ipoc, first or axes
            sen = xml.Element("Sen", Type="KROSHU")
            xml.SubElement(sen, "AK", {a: "%.6f" % (min(5, 0.0125 * k) if a == "A1" else 0) for a in AXES})
            xml.SubElement(sen, "IPOC").text = str(ipoc)
            here.sendto(xml.tostring(sen), at)
        peer.equal(read, 500, "messages with a type, six axes and an IPOC that grows")
        moved = axes[0] - first[0]
        peer.check(4.9 < moved < 5.05, "the first axis follows: %.2f degrees" % moved)
        peer.check(all(abs(a - b) < 0.01 for a, b in zip(axes[1:], first[1:])), "the others stand")
        peer.equal([rob.find("ASPos") is not None, rob.find("Delay") is not None], [True, True], "set points, late answers")
        sen = xml.Element("Sen", Type="KROSHU")
        xml.SubElement(sen, "Stop").text = "1"
        xml.SubElement(sen, "AK", {a: "5" if a == "A1" else "0" for a in AXES})
        xml.SubElement(sen, "IPOC").text = str(int(xml.fromstring(here.recvfrom(2048)[0]).find("IPOC").text))
        here.sendto(xml.tostring(sen), at)
        here.settimeout(0.3)
        ended = False
        try:
            for _ in range(20):
                here.recv(2048)
        except socket.timeout:
            ended = True
        peer.check(ended, "Stop ends the motion")
    finally:
        arm.terminate()
        arm.wait()
    peer.end()


def rob(axes, told, force, late, ipoc):
    """As a user's RSI configuration may have it: other elements between ours, another order and other cases, white space."""
    out = xml.Element("Rob", TYPE="KUKA")
    for name, x in ("RIst", [0] * 6), ("RSol", [0] * 6):
        xml.SubElement(out, name, dict(zip("XYZABC", map("%.4f".__mod__, x))))
    xml.SubElement(out, "Delay", D=str(late))
    xml.SubElement(out, "Tech", C11="0.0", C12="0.0")
    xml.SubElement(out, "FT", dict(zip("XYZABC", map("%.3f".__mod__, force))))
    xml.SubElement(out, "ASPos", dict(zip(AXES, map("%.6f".__mod__, told))))
    xml.SubElement(out, "AIPos", dict(zip(AXES, map("%.6f".__mod__, axes))))
    xml.SubElement(out, "DiO").text = "125"
    xml.SubElement(out, "IPOC").text = "%010d" % ipoc
    xml.indent(out, "\t")
    return xml.tostring(out, short_empty_elements=ipoc % 8 == 0)


def control(program):
    peer = Peer("expat %s, controller" % pyexpat.EXPAT_VERSION.removeprefix("expat_"))
    here, probe = (socket.socket(socket.AF_INET, socket.SOCK_DGRAM) for _ in range(2))
    here.bind(("127.0.0.1", 0))
    probe.bind(("127.0.0.1", 0))
    port = probe.getsockname()[1]
    probe.close()
    job = subprocess.Popen([program, "--robot", "rsi", "--bind", "127.0.0.1", "--port", str(port), "--type", "KROSHU",
                            "--duration", "4", "--quiet"])
    home = [0.0, 17.0, 11.0, 0.0, 57.0, 0.0]
    told, axes, correction = list(home), list(home), [0.0] * 6
    begun, stopped, last, late, answers, sent = None, False, None, 0, [], 0
    well_formed = numbered = typed = 0
    ipoc, next_at = 4208163634, time.monotonic()
    here.setblocking(False)
    while job.poll() is None and sent < 4000:
        t = 0 if begun is None else 0.004 * (sent - begun)
        share = max(0.0, min(1.0, (t - 1) / 0.2, (2 - t) / 0.2))  # a push, which begins 1 s after the first answer
        try:
            here.sendto(rob(axes, told, [0, 0, 40 * share, 0, 0, 0], late, ipoc), ("127.0.0.1", port))
        except OSError:
            pass  # the job is not there yet, or not any more
        sent += 1
        next_at += 0.004
        time.sleep(max(0, next_at - time.monotonic()))
        answered = False
        while True:
            try:
                sen = xml.fromstring(here.recv(2048))
            except OSError:
                break
            begun = sent if begun is None else begun
            well_formed += 1
            typed += sen.tag == "Sen" and sen.get("Type") == "KROSHU"
            number = int(sen.find("IPOC").text)
            numbered += number <= ipoc and (last is None or number > last)
            last = number
            if number == ipoc:  # what belongs to an earlier cycle a controller passes over
                answered = True
                correction = [float(sen.find("AK").get(a)) for a in AXES]
                answers.append((t, correction))
            stopped = sen.findtext("Stop") == "1"
        late += begun is not None and not answered and not stopped
        told = [h + c for h, c in zip(home, correction)]
        axes = [a + (q - a) * 0.125 for a, q in zip(axes, told)]  # a lag of 32 ms
        ipoc += 4
    peer.equal(job.wait(), 0, "exit code of the job")
    peer.require(len(answers) > 900, "%d answers in time, %d too late" % (len(answers), late))
    peer.equal([typed, numbered], [well_formed, well_formed], "each of %d answers with its SENTYPE and an IPOC that grows" % well_formed)
    def farthest(since, until):
        return max(abs(c) for t, all_ in answers if since <= t < until for c in all_)
    peer.check(farthest(0, 1) < 1e-3, "an arm that nobody pushes stands: %g degrees" % farthest(0, 1))
    pushed, back = farthest(1, 3), max(abs(c) for c in answers[-1][1])
    peer.check(0.3 < pushed < 20, "pushed by 40 N it gives way: %.2f degrees" % pushed)
    peer.check(back < 0.2 * pushed, "and comes back: %.3f degrees are left" % back)
    steps = max(abs(b - a) / 0.004 for (s, x), (t, y) in zip(answers, answers[1:]) if t - s < 0.006 for a, b in zip(x, y))
    peer.check(steps < 60, "no joint is told to turn faster than %.1f degrees/s" % steps)
    peer.check(stopped, "the last answer stops the motion")
    print("%d messages, %d answers, %d of them too late" % (sent, well_formed, late))
    peer.end()


(control if "--controller" in sys.argv else lead)(sys.argv[1])
