#!/usr/bin/env python3
"""Python's XML (expat, ElementTree) as the job of KUKA's RSI: it leads the simulated controller's first axis by 5 degrees.

rsi_peer.py PATH/simulated_arm
"""
import os
import pyexpat
import socket
import subprocess
import sys
import xml.etree.ElementTree as xml

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "../../support"))
from peer import Peer  # noqa: E402

AXES = ["A%d" % i for i in range(1, 7)]


def lead(program):
    peer = Peer("expat %s, job" % pyexpat.EXPAT_VERSION.removeprefix("expat_"))
    here = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
    here.bind(("127.0.0.1", 0))
    here.settimeout(10)
    arm = subprocess.Popen([program, "--protocol", "rsi", "--port", str(here.getsockname()[1]), "--quiet"])
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


lead(sys.argv[1])
