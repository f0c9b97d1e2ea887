# ROS 1 as its own code speaks it: a master (rosmaster) and a publisher (rospy) of a skin, 100 messages at 100 Hz.
#
#     python3 rospy_publisher.py MD5 < DEFINITION
#
# Prints the master's port. The message class is generated (genpy) from the definition; its sum has to be MD5.
import os
import sys
import threading
import time

os.environ["ROS_IP"] = "127.0.0.1"  # bind the loopback only
os.environ["ROS_MASTER_URI"] = "http://127.0.0.1:0"
try:
    import genpy.dynamic
    import rosmaster.master
    import rospy
except ImportError as e:
    print("absent:", e)
    sys.exit(77)

TYPE = "tum_ics_skin_msgs/SkinCellDataArray"
classes = genpy.dynamic.generate_dynamic(TYPE, sys.stdin.read())
Array, Cell = classes[TYPE], classes["tum_ics_skin_msgs/SkinCellData"]
if Array._md5sum != sys.argv[1]:
    sys.exit("genpy's sum of the definition is " + Array._md5sum)

master = rosmaster.master.Master(port=0)
master.start()
while not master.uri or master.uri.endswith(":0/"):
    time.sleep(0.01)
os.environ["ROS_MASTER_URI"] = master.uri
rospy.init_node("skin", disable_signals=True)
publisher = rospy.Publisher("/skin", Array, queue_size=10, tcp_nodelay=True)
print("ready port=%s" % master.uri.rstrip("/").rsplit(":", 1)[1], flush=True)

until = time.time() + 20
while publisher.get_num_connections() == 0 and time.time() < until:
    time.sleep(0.01)
for k in range(100):
    message = Array()
    for i in range(40):
        cell = Cell()
        cell.cellId, cell.ts = i, time.time_ns()
        cell.prox, cell.force, cell.acc, cell.temp = [0.5], [k / 512, 0.0, 0.25], [0.0, 0.0, 1.0], [30.5, 31.0]
        message.data.append(cell)
    publisher.publish(message)
    time.sleep(0.01)
print("published 100, connections %d" % publisher.get_num_connections(), flush=True)
os._exit(0)
