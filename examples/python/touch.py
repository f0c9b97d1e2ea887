"""A touch, step by step: the arm goes to a goal, is pressed on the forearm on its way, gives way, and comes back.

    PYTHONPATH=build/release/bin python3 examples/python/touch.py touch.svg
"""
import sys
import time

import numpy as np
import skinctl_ur5

# %% An arm that stands, its loop in a thread of its own
arm = skinctl_ur5.Ur5(force_gain=40)
arm.start()
time.sleep(0.5)

# %% A goal, and a finger on the forearm for a second
arm.goal(skinctl_ur5.home + [0.4, 0, 0, 0, 0, 0], duration=2)
time.sleep(0.8)
arm.touch(cell=110, reading=0.5)
time.sleep(1.0)
arm.touch(cell=110, reading=0)
time.sleep(3.0)
arm.stop()

# %% What happened, as arrays
run = arm.take()
t, q = run["time"] - run["time"][0], run["q"]
skin = run["shares"][:, skinctl_ur5.laws.index("skin joint")]
touched = np.abs(skin).max(axis=1) > 1e-6
print(f"{len(t)} cycles, {run['dropped']} without room")
print(f"touched from {t[touched][0]:.2f} s to {t[touched][-1]:.2f} s, up to {np.abs(skin).max():.1f} N m")
print(f"at the end {abs(q[-1, 0] - skinctl_ur5.home[0] - 0.4):.3f} rad beside its goal")

# %% A picture: the joints' way, and the torque of the skin
size, left, top, tall = (640, 360), 46, 14, 130


def curves(values, y, names, unit):
    low, high = values.min(), values.max() + 1e-9
    out = [f'<text x="4" y="{y + 10}">{unit}</text>', f'<text x="4" y="{y + tall}">{low:.1f}</text>', f'<text x="4" y="{y + 24}">{high:.1f}</text>']
    wide = size[0] - left - 70
    x, level = lambda a: left + wide * a / t[-1], y + tall * high / (high - low)
    out.append(f'<rect x="{x(t[touched][0]):.1f}" y="{y}" width="{x(t[touched][-1]) - x(t[touched][0]):.1f}" height="{tall}" fill="#f3e3c3"/>')
    out.append(f'<rect x="{left}" y="{y}" width="{wide}" height="{tall}" fill="none" stroke="#999"/>')
    out.append(f'<line x1="{left}" y1="{level:.1f}" x2="{left + wide}" y2="{level:.1f}" stroke="#ccc"/>')
    for s in range(int(t[-1]) + 1):
        out.append(f'<text x="{x(s):.1f}" y="{y + tall + 14}" text-anchor="middle">{s} s</text>')
    for k, color in enumerate(("#0072b2", "#d55e00", "#009e73", "#cc79a7", "#56b4e9", "#b8860b")):
        points = " ".join(f"{x(a):.1f},{y + tall - tall * (b - low) / (high - low):.1f}" for a, b in zip(t, values[:, k]))
        out.append(f'<polyline points="{points}" fill="none" stroke="{color}" stroke-width="1.5"/>')
        out.append(f'<text x="{size[0] - 64}" y="{y + 14 + 16 * k}" fill="{color}">{names[k]}</text>')
    return out


joints = ("pan", "lift", "elbow", "wrist 1", "wrist 2", "wrist 3")
svg = [f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {size[0]} {size[1]}" font-family="sans-serif" font-size="11">', '<rect width="100%" height="100%" fill="white"/>']
svg += curves(q - q[0], top, joints, "rad")
svg += curves(skin, top + tall + 40, joints, "N m")
svg += [f'<text x="{left}" y="{size[1] - 8}">above, the way of each joint; below, what the skin asks of it while it is touched</text>', "</svg>"]
if len(sys.argv) > 1:
    open(sys.argv[1], "w").write("\n".join(svg))
