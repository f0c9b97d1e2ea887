#!/usr/bin/env python3
"""ROS's rosbag writes bags of a skin, plain and compressed, and reads what skin_bridge writes (of temperatures, the first).

rosbag_peer.py PATH/skin_bridge
"""
import os
import subprocess
import sys
import tempfile

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "../../support"))
from peer import Peer, skip, version  # noqa: E402

try:
    import genpy
    import genpy.dynamic
    import rosbag
except ImportError:
    skip("python3-rosbag")

TYPE = "tum_ics_skin_msgs/SkinCellDataArray"
DEFINITION = ("SkinCellData[] data\n" + "=" * 80 + "\nMSG: tum_ics_skin_msgs/SkinCellData\n"
              "int32 cellId\nint64 ts\nfloat64[] prox\nfloat64[] force\nfloat64[] acc\nfloat64[] temp\n")
PROGRAM = sys.argv[1]
peer = Peer("rosbag %s" % version("rosbag"))
classes = genpy.dynamic.generate_dynamic(TYPE, DEFINITION)
Array, Cell = classes[TYPE], classes["tum_ics_skin_msgs/SkinCellData"]


def message(k):
    out = Array()
    for i in range(40):
        out.data.append(Cell(cellId=i, ts=10**18 + 10**7 * k, prox=[0.5], force=[k / 512, 0.0, 0.25], acc=[0.0, 0.0, 1.0],
                             temp=[30.5, 31.0]))
    return out


def carry(name, to):
    job = subprocess.run([PROGRAM, "-q", "--from", "bag:" + name, "--to", "bag:" + to, "--topic", "/skin", "--speed", "100"],
                         stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, timeout=60)
    return job.returncode, job.stdout


with tempfile.TemporaryDirectory() as folder:
    for compression in (rosbag.Compression.NONE, rosbag.Compression.BZ2, rosbag.Compression.LZ4):
        name, to = os.path.join(folder, compression + ".bag"), os.path.join(folder, compression + "_carried.bag")
        try:
            with rosbag.Bag(name, "w", compression=compression, chunk_threshold=20000) as bag:
                for k in range(100):
                    bag.write("/skin", message(k), genpy.Time.from_sec(1e9 + k / 100))
        except Exception as e:  # without its own module
            print("rosbag has no %s here: %s" % (compression, e))
            continue
        code, said = carry(name, to)
        peer.equal((code, said), (0, "100 messages, 4000 samples, 0 refused\n"), compression + ", carried")
        with rosbag.Bag(to) as bag:
            peer.equal(bag.get_message_count(), 100, compression + ", messages")
            types, topics = bag.get_type_and_topic_info()
            peer.equal((topics["/skin"].msg_type, types), (TYPE, {TYPE: Array._md5sum}), compression + ", type and sum")
            same, stamps = 0, []
            for k, (topic, m, time) in enumerate(bag.read_messages()):
                stamps.append(time.to_sec())
                same += (topic == "/skin" and [c.cellId for c in m.data] == list(range(40)) and
                         all(c.prox == (0.5,) and c.force == (k / 512, 0.0, 0.25) and c.temp == (30.5,) and
                             max(abs(a - b) for a, b in zip(c.acc, (0, 0, 1))) < 1e-6 for c in m.data))
            peer.equal(same, 100, compression + ", every field")
            peer.check(all(a <= b for a, b in zip(stamps, stamps[1:])), compression + ", in order")
    with open(name, "rb") as file:
        whole = file.read()
    with open(name, "wb") as file:
        file.write(whole[:len(whole) // 2])
    code, said = carry(name, os.path.join(folder, "half.bag"))
    peer.check(code != 0, "half a bag does not end as carried: " + said)
peer.end()
