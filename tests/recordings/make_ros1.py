# SPDX-License-Identifier: Apache-2.0
"""Writes bag1_*.bag and tf1.bag with Debian's python3-rosbag, python3-sensor-msgs, python3-geometry-msgs and
python3-tf2-msgs: the messages of make_bags.mjs, for src/elastocal/readers/bags_test.cpp. Run in this folder."""
import math

import genpy
import rosbag
from geometry_msgs.msg import PoseStamped, TransformStamped
from sensor_msgs.msg import JointState
from std_msgs.msg import String
from tf2_msgs.msg import TFMessage



def write_joints(bag, i, stamp, received):
    state = JointState(name=["elbow", "wrist"], position=[0.125 * i, -0.5 * i], effort=[] if i == 4 else [i, math.nan])
    state.header.stamp = stamp
    bag.write("/joint_states", state, received)


for compression in ("none", "lz4", "bz2"):
    with rosbag.Bag(f"bag1_{compression}.bag", "w", compression=compression, chunk_threshold=2000) as bag:
        for i in range(20):
            stamp = genpy.Time(1700000000, i * 10000000)
            received = stamp + genpy.Duration(0, 3000000)
            if i % 2 == 0:
                write_joints(bag, i, stamp, received)
            if i != 7:
                pose = PoseStamped()
                pose.header.stamp = stamp
                pose.header.frame_id = "world"
                pose.pose.position.x, pose.pose.position.y, pose.pose.position.z = 1 + 0.01 * i, -2, 0.5
                pose.pose.orientation.z = pose.pose.orientation.w = math.sqrt(0.5)
                bag.write("/mocap/LHAND/pose", pose, received)
            bag.write("/chatter", String("hello " * 20 + str(i)), received)


def transform(stamp, parent, child, position, turn=(0, 0, 0, 1)):
    one = TransformStamped(child_frame_id=child)
    one.header.stamp, one.header.frame_id = stamp, parent
    move = one.transform
    move.translation.x, move.translation.y, move.translation.z = position
    move.rotation.x, move.rotation.y, move.rotation.z, move.rotation.w = turn
    return one


with rosbag.Bag("tf1.bag", "w", compression="bz2") as bag:
    turn = (0, 0, math.sqrt(0.5), math.sqrt(0.5))
    begin = genpy.Time(1700000000, 0)
    bag.write("/tf_static", TFMessage([transform(begin, "room", "cameras", (10, 20, 30), turn),
                                       transform(begin, "cameras/LHAND", "tool", (0, 0, 0.25), turn)]), begin)
    for i in range(20):
        stamp = genpy.Time(1700000000, i * 10000000)
        received = stamp + genpy.Duration(0, 3000000)
        if i % 2 == 0:
            write_joints(bag, i, stamp, received)
        moves = [transform(stamp, "/room", "/base_link", (0.1 * i, 0, 0)),
                 transform(stamp, "/base_link", "/elbow_link", (0, 0, 1))]
        if i != 7:
            moves.append(transform(stamp, "/cameras", "/cameras/LHAND", (1 + 0.01 * i, -2, 0.5), turn))
        bag.write("/tf", TFMessage(moves), received)
