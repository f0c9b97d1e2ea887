#!/usr/bin/env python3
"""python-can at an slcan adapter is the host of a simulated Allegro Hand V4, with numbers from the maker's guide.

can_peer.py PATH/simulated_allegro
"""
import os
import struct
import subprocess
import sys
import time

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "../../support"))
from peer import Peer, skip, version  # noqa: E402

try:
    import can
    import serial  # noqa: F401  # python-can's slcan needs it
except ImportError:
    skip("python3-can python3-serial")

SERVO_ON, SERVO_OFF, TORQUE, POSITION, TEMPERATURE, INFO, PERIOD, SERIAL = 0x40, 0x41, 0x60, 0x20, 0x38, 0x80, 0x81, 0x88


def open_bus(line):
    return can.Bus(interface="slcan", channel=line, bitrate=1000000, sleep_after_open=0.1)


def frame(message, data=b"", remote=False):
    return can.Message(arbitration_id=message << 2, data=data, is_extended_id=False, is_remote_frame=remote)


def be_host(program):
    peer = Peer("python-can %s, host" % version("python-can"))
    hand = subprocess.Popen([program, "--generation", "v4"], stdout=subprocess.PIPE, text=True)
    try:
        bus = open_bus(hand.stdout.readline().split()[1])

        def hear(message, seconds=2.0):
            until = time.monotonic() + seconds
            while time.monotonic() < until:
                m = bus.recv(0.1)
                if m is not None and m.arbitration_id == message << 2:
                    return m
            return None

        def positions():
            got = {}
            until = time.monotonic() + 2
            while len(got) < 4 and time.monotonic() < until:
                m = bus.recv(0.1)
                if m is not None and POSITION <= m.arbitration_id >> 2 < POSITION + 4:
                    got[(m.arbitration_id >> 2) - POSITION] = struct.unpack("<4h", m.data)
            return [[n * 333.3 / 65536 for n in got[f]] for f in range(4)] if len(got) == 4 else None

        bus.send(frame(SERVO_OFF))
        bus.send(frame(INFO, remote=True))
        info = hear(INFO)
        if peer.check(info is not None and info.dlc == 7 and not info.is_remote_frame, "information, seven bytes"):
            peer.equal(info.data[1], 4, "hardware of a V4")
            peer.equal(info.data[4], 0, "a right hand")
            peer.equal(info.data[6], 0, "servo off, no fault")
        bus.send(frame(SERIAL, remote=True))
        serial_ = hear(SERIAL)
        peer.check(serial_ is not None and bytes(serial_.data).isascii() and serial_.dlc == 8, "a serial number")
        bus.send(frame(PERIOD, struct.pack("<3H", 30, 0, 300)))  # slower than 3 ms: every byte takes Python's time
        bus.send(frame(SERVO_ON))
        first = positions()
        if peer.check(first is not None, "positions of four fingers"):
            peer.check(all(-60 < q < 120 for f in first for q in f), "within a hand's reach: %r" % first)
        heat = hear(TEMPERATURE)
        peer.check(heat is not None and 10 < heat.data[0] < 80, "a temperature")
        bus.send(frame(INFO, remote=True))
        info = hear(INFO)
        peer.check(info is not None and info.data[6] == 1, "servo on")
        for k in range(30):  # the index finger's second joint; torques of all four fingers count together
            for finger in range(4):
                bus.send(frame(TORQUE + finger, struct.pack("<4h", 0, 300 if finger == 0 else 0, 0, 0)))
            time.sleep(0.01)
        while bus.recv(0) is not None:
            pass
        last = positions()
        if peer.check(first is not None and last is not None, "positions once more"):
            moved = last[0][1] - first[0][1]
            peer.check(moved > 2, "pushed forward, the joint bends: %.1f degrees" % moved)
        bus.send(frame(SERVO_OFF))
        bus.send(frame(PERIOD, struct.pack("<3H", 0, 0, 0)))
        time.sleep(0.2)
        while bus.recv(0) is not None:
            pass
        peer.check(hear(POSITION, 0.3) is None, "silence once no period is asked for")
        bus.shutdown()
    finally:
        hand.terminate()
        hand.wait()
    peer.end()


be_host(sys.argv[1])
