"""Goals, touches, copies, and what is refused. The arm runs as fast as it can, so that this takes no time."""
import time

import numpy as np
import skinctl_ur5


def run(*steps):
    """Runs the steps, and then until the arm has had 20 s of its own time."""
    arm = skinctl_ur5.Ur5(force_gain=40, real_time=False)
    for step in steps:
        step(arm)
    arm.start()
    parts, until = [], time.monotonic() + 30
    while not parts or parts[-1]["time"][-1] < 20:
        assert time.monotonic() < until, "the loop stands"
        part = arm.take()
        if len(part["time"]):
            parts.append(part)
        time.sleep(0.001)
    arm.stop()
    return {key: np.concatenate([p[key] for p in parts]) for key in ("time", "q", "shares", "status")}


goal = skinctl_ur5.home + [0.3, 0.1, 0, 0, 0, 0]
reached = run(lambda arm: arm.goal(goal, 2.0))
assert reached["q"].shape[1:] == (6,) and reached["shares"].shape[1:] == (3, 6)
assert np.abs(reached["q"][-1] - goal).max() < 0.01, reached["q"][-1] - goal
assert np.abs(reached["shares"][:, 1]).max() == 0

pressed = run(lambda arm: arm.touch(110, 0.5))
assert np.abs(pressed["shares"][:, 1]).max() > 1
assert np.abs(pressed["q"] - skinctl_ur5.home).max() > 0.05

arm = skinctl_ur5.Ur5()
for wrong in (lambda: arm.goal(np.zeros(5)), lambda: arm.touch(0, 0.5), lambda: arm.touch(1, 2), lambda: arm.touch(1, float("nan"))):
    try:
        wrong()
    except ValueError:
        continue
    raise AssertionError("not refused")
assert skinctl_ur5.reasons(0) == []
print("fine")
