#!/usr/bin/env python3
"""Google's protobuf as the other end of EGM: it reads what is written here, and what it writes is read.

egm_peer.py PATH/simulated_arm                a job that leads the simulated controller's first joint
egm_peer.py PATH/compliant_arm --controller   a controller around the job, which stands still
"""
import socket
import subprocess
import sys
import time

from protobuf_peer import DOUBLE, ENUM, MANY, ONE, UINT, check, classes, peer

MESSAGES = {
    "Header": [("seqno", 1, UINT, ONE), ("tm", 2, UINT, ONE), ("mtype", 3, ENUM, ONE)],
    "Joints": [("joints", 1, DOUBLE, MANY)],
    "Pose": [("joints", 1, "Joints", ONE)],
    "Said": [("state", 1, ENUM, ONE)],
    "Force": [("force", 1, DOUBLE, MANY)],
    "Robot": [("header", 1, "Header", ONE), ("feedBack", 2, "Pose", ONE), ("planned", 3, "Pose", ONE),
              ("motorState", 4, "Said", ONE), ("mciState", 5, "Said", ONE),
              ("rapidExecState", 8, "Said", ONE), ("measuredForce", 9, "Force", ONE)],
    "Sensor": [("header", 1, "Header", ONE), ("planned", 2, "Pose", ONE)],
}


def lead(program, Robot, Sensor):
    here = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
    here.bind(("127.0.0.1", 0))
    here.settimeout(10)
    arm = subprocess.Popen([program, "--protocol", "egm", "--port", str(here.getsockname()[1]), "--speed", "0",
                            "--quiet"])
    try:
        first = last = None
        for k in range(400):
            data, at = here.recvfrom(2048)
            robot = Robot.FromString(data)
            check(robot.IsInitialized() and robot.header.mtype == 2, "a header of data")
            check(len(robot.feedBack.joints.joints) == 6, "six joints")
            check(len(robot.measuredForce.force) == 6, "six numbers of force")
            if last is not None:
                check(robot.header.seqno > last, "numbers that grow")
            last = robot.header.seqno
            if first is None:
                first = list(robot.feedBack.joints.joints)
            if robot.mciState.state != 3:
                continue
            sensor = Sensor()
            sensor.header.seqno, sensor.header.tm, sensor.header.mtype = k, robot.header.tm, 3
            goal = list(first)
            goal[0] += 0.02 * k
            sensor.planned.joints.joints.extend(goal)
            here.sendto(sensor.SerializeToString(), at)
        moved = robot.feedBack.joints.joints[0] - first[0]
        check(5 < moved < 8, "the joint follows: %.2f degrees" % moved)
        print("400 messages, joint 1 led by %.2f degrees" % moved)
    finally:
        arm.terminate()
        arm.wait()


def control(program, Robot, Sensor):
    here = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
    here.bind(("127.0.0.1", 0))
    probe = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
    probe.bind(("127.0.0.1", 0))
    port = probe.getsockname()[1]
    probe.close()
    job = subprocess.Popen([program, "--robot", "egm", "--bind", "127.0.0.1", "--port", str(port),
                            "--duration", "1", "--quiet"])
    home = [0.0, 17.0, 11.0, 0.0, 57.0, 0.0]
    answers = 0
    here.setblocking(False)
    next_at = time.monotonic()
    number = 0
    while job.poll() is None and number < 4000:
        robot = Robot()
        robot.header.seqno, robot.header.tm, robot.header.mtype = number, 4 * number, 2
        robot.feedBack.joints.joints.extend(home)
        robot.planned.joints.joints.extend(home)
        robot.motorState.state, robot.mciState.state, robot.rapidExecState.state = 1, 3, 2
        robot.measuredForce.force.extend([0.0] * 6)
        try:
            here.sendto(robot.SerializeToString(), ("127.0.0.1", port))
        except OSError:
            pass
        number += 1
        next_at += 0.004
        time.sleep(max(0, next_at - time.monotonic()))
        while True:
            try:
                data = here.recv(2048)
            except OSError:
                break
            sensor = Sensor.FromString(data)
            check(sensor.header.mtype == 3 and len(sensor.planned.joints.joints) == 6, "a correction of six")
            off = max(abs(a - b) for a, b in zip(sensor.planned.joints.joints, home))
            check(off < 1e-3, "an arm that nobody pushes stands: %g degrees" % off)
            answers += 1
    check(job.wait() == 0, "exit %d of the job" % job.returncode)
    check(answers > 200, "%d answers" % answers)
    print("%d messages, %d answers" % (number, answers))


def main():
    Robot, Sensor = classes("egm", MESSAGES, ("Robot", "Sensor"))
    (control if "--controller" in sys.argv else lead)(sys.argv[1], Robot, Sensor)
    peer.end()


main()
