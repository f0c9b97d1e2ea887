#!/usr/bin/env python3
"""Google's protobuf as the other end of FRI: it reads what is written here, and what it writes is read.

fri_peer.py PATH/simulated_arm                a job that leads the simulated iiwa's first joint
fri_peer.py PATH/compliant_arm --controller   a controller around the job, whose arm stands still
"""
import math
import socket
import subprocess
import sys
import time

from protobuf_peer import DOUBLE, ENUM, MANY, ONE, UINT, check, classes, peer

MESSAGES = {
    "Header": [("id", 1, UINT, ONE), ("number", 2, UINT, ONE), ("reflected", 3, UINT, ONE)],
    "Joints": [("value", 1, DOUBLE, MANY)],
    "Info": [("joints", 1, UINT, ONE), ("safety", 2, ENUM, ONE), ("drive", 5, ENUM, MANY),
             ("operation", 6, ENUM, ONE), ("control", 7, ENUM, ONE)],
    "Time": [("sec", 1, UINT, ONE), ("nanosec", 2, UINT, ONE)],
    "Data": [("measured", 1, "Joints", ONE), ("torque", 2, "Joints", ONE), ("commanded", 3, "Joints", ONE),
             ("commanded_torque", 4, "Joints", ONE), ("external", 5, "Joints", ONE), ("time", 15, "Time", ONE)],
    "Connection": [("session", 1, ENUM, ONE), ("quality", 2, ENUM, ONE), ("period", 3, UINT, ONE),
                   ("multiplier", 4, UINT, ONE)],
    "Motion": [("joints", 1, "Joints", ONE), ("mode", 10, ENUM, ONE), ("overlay", 11, ENUM, ONE),
               ("tracking", 12, DOUBLE, ONE)],
    "End": [("length", 1, UINT, ONE), ("checksum", 2, UINT, ONE)],
    "Monitoring": [("header", 1, "Header", ONE), ("info", 2, "Info", ONE), ("data", 3, "Data", ONE),
                   ("connection", 4, "Connection", ONE), ("motion", 5, "Motion", ONE), ("end", 15, "End", ONE)],
    "CommandData": [("position", 1, "Joints", ONE), ("torque", 3, "Joints", ONE)],
    "Command": [("header", 1, "Header", ONE), ("data", 2, "CommandData", ONE)],
}
MONITORING, COMMAND = 0x245142, 0x34001
WAIT, READY, COMMANDING_WAIT, COMMANDING = 1, 2, 3, 4
GOOD = 2


def udp(blocks):
    s = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
    s.bind(("127.0.0.1", 0))
    if blocks:
        s.settimeout(10)
    else:
        s.setblocking(False)
    return s


def command_of(Command, number, reflected, joints):
    c = Command()
    c.header.id, c.header.number, c.header.reflected = COMMAND, number, reflected
    if joints is not None:
        c.data.position.value.extend(joints)
    return c.SerializeToString()


def lead(program, Monitoring, Command):
    vector = command_of(Command, 1, 5, [0.0] * 7)
    check(vector[:10].hex() == "0a080881800d10011805" and len(vector) == 77, "bytes: " + vector[:10].hex())
    here = udp(True)
    arm = subprocess.Popen([program, "--protocol", "fri", "--port", str(here.getsockname()[1]), "--speed", "0",
                            "--quiet"])
    try:
        first, commanded, seen = None, 0, set()
        for k in range(500):
            data, at = here.recvfrom(2048)
            m = Monitoring.FromString(data)
            check(m.IsInitialized() and m.header.id == MONITORING, "an identifier")
            check(m.info.joints == 7 and len(m.data.measured.value) == 7, "seven joints")
            check(len(m.data.external.value) == 7, "seven torques of the world")
            seen.add(m.connection.session)
            goal = list(m.motion.joints.value) if m.connection.session == COMMANDING_WAIT else list(m.data.commanded.value)
            if m.connection.session == COMMANDING:
                first = first or list(m.data.commanded.value)
                commanded += 1
                goal = list(first)
                goal[0] += 0.1 * (1 - math.cos(min(1.0, 0.004 * commanded) * math.pi)) / 2
            here.sendto(command_of(Command, k, m.header.number, goal), at)
        check(seen == {WAIT, READY, COMMANDING_WAIT, COMMANDING}, "session states %s" % sorted(seen))
        moved = m.data.measured.value[0] - first[0]
        check(0.095 < moved < 0.105, "the joint follows: %.3f rad" % moved)
        print("500 messages, joint 1 led by %.3f rad" % moved)
    finally:
        arm.terminate()
        arm.wait()


def control(program, Monitoring, Command):
    here, probe = udp(False), udp(False)
    port = probe.getsockname()[1]
    probe.close()
    job = subprocess.Popen([program, "--robot", "fri", "--bind", "127.0.0.1", "--port", str(port),
                            "--stiffness", "500", "--duration", "1", "--quiet"])
    home = [0.0, 0.5, 0.0, -1.3, 0.0, 1.3, 0.0]
    session, steady, answers, number = WAIT, 0, 0, 0
    last = None
    next_at = time.monotonic()
    while job.poll() is None and number < 4000:
        m = Monitoring()
        m.header.id, m.header.number, m.header.reflected = MONITORING, number, last or 0
        m.info.joints, m.info.safety, m.info.control = 7, 0, 2
        m.info.drive.extend([2] * 7)
        m.data.measured.value.extend(home)
        m.data.torque.value.extend([0.0] * 7)
        m.data.commanded.value.extend(home)
        m.data.external.value.extend([0.1] * 7)
        m.data.time.sec, m.data.time.nanosec = number // 250, 4000000 * (number % 250)
        m.connection.session, m.connection.quality = session, GOOD + 1
        m.connection.period, m.connection.multiplier = 4, 1
        if session >= COMMANDING_WAIT:
            m.motion.joints.value.extend(home)
            m.motion.mode, m.motion.overlay, m.motion.tracking = 1, 1, 1.0
        m.end.length, m.end.checksum = 1, 2
        try:
            here.sendto(m.SerializeToString(), ("127.0.0.1", port))
        except OSError:
            pass
        next_at += 0.004
        time.sleep(max(0, next_at - time.monotonic()))
        while True:
            try:
                data = here.recv(2048)
            except OSError:
                break
            c = Command.FromString(data)
            check(c.header.id == COMMAND and len(c.data.position.value) == 7, "a command of seven")
            check(c.header.reflected <= number, "a counter that was sent")
            check(last is None or c.header.number == last + 1, "own counters grow by one")
            last = c.header.number
            off = max(abs(a - b) for a, b in zip(c.data.position.value, home))
            check(off < 1e-3, "an arm that nobody pushes stands: %g rad" % off)
            answers += 1
            steady += 1
        if steady > 5 and session < COMMANDING:
            session, steady = session + 1, 0
        number += 1
    check(job.wait() == 0, "exit %d of the job" % job.returncode)
    check(answers > 200 and session == COMMANDING, "%d answers" % answers)
    print("%d messages, %d answers" % (number, answers))


def main():
    Monitoring, Command = classes("fri", MESSAGES, ("Monitoring", "Command"))
    (control if "--controller" in sys.argv else lead)(sys.argv[1], Monitoring, Command)
    peer.end()


main()
