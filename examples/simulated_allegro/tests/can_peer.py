#!/usr/bin/env python3
"""python-can at an slcan adapter is the other end of an Allegro Hand V4's bus, with numbers from the maker's guide.

can_peer.py PATH/simulated_allegro          the host of the simulated hand
can_peer.py PATH/compliant_allegro --hand   the hand under the job: its joints turn as the torques say
"""
import math
import os
import pty
import select
import struct
import subprocess
import sys
import time
import tty

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


STEP = math.radians(333.3 / 65536)  # of the encoders
NEWTON_METRES = 0.7 / 1200  # of one PWM, as the job assumes where nobody says --full-torque
OPEN = [0, 0.3, 0.3, 0.3] * 3 + [0.9, 0.3, 0.3, 0.3]  # the posture that the job takes first


def wire():
    """The names of two terminals, each of which hears what the other says."""
    ends = [pty.openpty() for _ in range(2)]
    for pair in ends:
        for fd in pair:
            tty.setraw(fd)
    masters = [master for master, _ in ends]
    mine = os.getpid()
    if os.fork() == 0:  # beside the interpreter of the hand
        while os.getppid() == mine:
            for fd in select.select(masters, [], [], 1)[0]:
                os.write(masters[1 - masters.index(fd)], os.read(fd, 4096))
        os._exit(0)
    return [os.ttyname(slave) for _, slave in ends]


def in_real_time():
    """As simulated hands ask for it; where that is refused, as the machine has time."""
    try:
        os.sched_setscheduler(0, os.SCHED_FIFO, os.sched_param(20))
    except OSError:
        pass


class Hand:
    """Sixteen joints without mass, whose friction also holds what the job adds for a weight, and what the job told them."""

    DAMPING, FRICTION = 0.05, 0.015  # [N m s/rad], [N m]

    def __init__(self, line):
        self.bus = open_bus(line)
        self.q = [0.1 + 0.02 * i for i in range(16)]
        self.torque, self.push, self.pause = [0.0] * 16, [0.0] * 16, 0
        self.servo, self.hot, self.period, self.told, self.strangers, self.sets, self.largest = False, False, 0, [], 0, 0, 0

    def hear(self, m):
        message = m.arbitration_id >> 2
        if m.arbitration_id & 3 or m.is_extended_id:
            self.strangers += 1
        elif m.is_remote_frame and message == INFO:
            self.told.append("information")
            self.bus.send(frame(INFO, struct.pack("<HHBBB", 0x0402, 0x0105, 0, 40, self.servo | 2 * self.hot)))
        elif m.is_remote_frame and message == SERIAL:
            self.told.append("serial")
            self.bus.send(frame(SERIAL, b"AHR4 001"))
        elif message in (SERVO_ON, SERVO_OFF) and m.dlc == 0:
            self.servo = message == SERVO_ON
            self.told.append("on" if self.servo else "off")
            self.torque = [0.0] * 16
        elif message == PERIOD and m.dlc == 6:
            self.period = struct.unpack("<3H", m.data)[0]
            self.told.append("period %d" % self.period)
        elif TORQUE <= message < TORQUE + 4 and m.dlc == 8:
            finger = message - TORQUE
            pwm = struct.unpack("<4h", m.data)
            self.largest = max(self.largest, *map(abs, pwm))
            self.torque[4 * finger:4 * finger + 4] = [NEWTON_METRES * x for x in pwm]
            self.sets += finger == 3
        else:
            self.strangers += 1

    def turn(self, seconds):
        if self.servo:
            for i, torque in enumerate(map(sum, zip(self.torque, self.push))):
                self.q[i] += seconds * math.copysign(max(0, abs(torque) - self.FRICTION), torque) / self.DAMPING

    def tell(self):
        for finger in range(4):
            self.bus.send(frame(POSITION + finger, struct.pack("<4h", *(round(q / STEP) for q in self.q[4 * finger:4 * finger + 4]))))

    def live(self, job, push=None, hot_after=None):
        """Until the job has ended. A finger pushes for half a second, 0.3 s after the open posture was reached; how far off that
        was, where the joint was pushed to, and where it came back to."""
        begun, before, next_at, over, there, off, bend, back = None, time.monotonic(), 0, None, None, math.inf, 0, 0
        while over is None or before < over + 0.3:  # its last words may still be on the way
            now = time.monotonic()
            if over is None and job.poll() is not None:
                over = now
            if self.period and now >= next_at:
                self.tell()
                next_at = max(next_at + 0.001 * self.period, now)
            if self.servo and begun is None:
                begun = now
            self.hot = hot_after is not None and begun is not None and now > begun + hot_after
            if push is not None and self.servo:
                joint, torque = push
                off = max(abs(q - o) for q, o in zip(self.q, OPEN)) if there is None else off
                there = now if there is None and off < 0.05 else there
                pushes = there is not None and 0.3 <= now - there < 0.8
                self.push[joint] = torque if pushes else 0.0
                bend = max(bend, self.q[joint]) if pushes else bend
                back = self.q[joint]
            self.turn(now - before)
            self.pause = max(self.pause, now - before if self.servo else 0)
            before = now
            m = self.bus.recv(max(0.0, min(0.001 * self.period or 0.01, next_at - time.monotonic())))
            while m is not None:
                self.hear(m)
                m = self.bus.recv(0)
        return off, bend, back


def be_hand(program):
    peer = Peer("python-can %s, hand" % version("python-can"))
    in_real_time()
    for _ in range(3):
        here, there = wire()
        hand = Hand(here)
        job = subprocess.Popen([program, "--can", there, "--generation", "v4", "--stiffness", "2", "--duration", "8", "--quiet"])
        off, bend, back = hand.live(job, push=(5, 0.15))
        if hand.pause < 0.03:
            break
        print("this machine left the hand waiting for %.0f ms" % (1000 * hand.pause))
    else:
        print("skipped: nothing is proven on a machine that does not run what is due")
        sys.exit(77)
    peer.equal(job.wait(), 0, "exit code of the job")
    peer.equal([w for w in hand.told[:6] if w != "information"], ["off", "serial", "period 3", "on"], "how it begins")
    peer.check(hand.told.index("information") == 1, "it asks for the information before anything else")
    peer.equal([w for w in hand.told if w != "information"][-3:], ["off", "period 0", "off"], "how it ends")
    peer.check(hand.told.count("information") > 20, "asked for its state %d times in 8 s" % hand.told.count("information"))
    peer.equal(hand.strangers, 0, "frames that a V4 does not know")
    peer.check(hand.sets > 600, "%d sets of torques in 8 s" % hand.sets)
    peer.check(0 < hand.largest <= 675, "at most %d PWM" % hand.largest)
    peer.check(off < 0.05, "the posture that was asked for, within %.3f rad" % off)
    peer.check(0.05 < bend - OPEN[5] < 1.2, "pushed by 0.15 N m, a joint gives way by %.3f rad" % (bend - OPEN[5]))
    peer.check(abs(back - OPEN[5]) < 0.06, "and comes back within %.3f rad" % abs(back - OPEN[5]))

    here, there = wire()
    hand = Hand(here)
    job = subprocess.Popen([program, "--can", there, "--generation", "v4", "--duration", "20", "--quiet"], stderr=subprocess.PIPE, text=True)
    hand.live(job, hot_after=0.5)
    peer.equal(job.wait(), 5, "exit code with a hand that is too hot")
    peer.check("too hot" in job.stderr.read(), "and its words")
    peer.check(not hand.servo and hand.period == 0, "its servo is off, it is told to be silent")
    peer.end()


(be_hand if "--hand" in sys.argv else be_host)(sys.argv[1])
