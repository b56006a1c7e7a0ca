// SPDX-License-Identifier: Apache-2.0
// Writes bag_*.mcap, tf.mcap, messages.json and transforms.json for src/elastocal/readers/bags_test.cpp:
//   node make_bags.mjs FOLDER
// It uses other people's libraries: npm must have installed @mcap/core, @foxglove/rosmsg2-serialization,
// @foxglove/rosmsg and @foxglove/rosmsg-msgs-common, and /usr/bin/python3 must have lz4 and zstandard.
import { spawnSync } from "node:child_process";
import { createRequire } from "node:module";
import { writeFileSync } from "node:fs";
import { join, resolve } from "node:path";

const require = createRequire(join(resolve(process.argv[2]), "x.js"));
const { McapWriter, TempBuffer } = require("@mcap/core");
const { MessageWriter } = require("@foxglove/rosmsg2-serialization");
const { parse } = require("@foxglove/rosmsg");

const TIME = "uint32 sec\nuint32 nanosec\n";
const HEADER = "builtin_interfaces/Time stamp\nstring frame_id\n";
const definitions = {
  "sensor_msgs/msg/JointState":
    "std_msgs/Header header\nstring[] name\nfloat64[] position\nfloat64[] velocity\nfloat64[] effort\n" +
    "===\nMSG: std_msgs/Header\n" + HEADER + "===\nMSG: builtin_interfaces/Time\n" + TIME,
  "geometry_msgs/msg/PoseStamped":
    "std_msgs/Header header\ngeometry_msgs/Pose pose\n" +
    "===\nMSG: geometry_msgs/Pose\ngeometry_msgs/Point position\ngeometry_msgs/Quaternion orientation\n" +
    "===\nMSG: geometry_msgs/Point\nfloat64 x\nfloat64 y\nfloat64 z\n" +
    "===\nMSG: geometry_msgs/Quaternion\nfloat64 x\nfloat64 y\nfloat64 z\nfloat64 w\n" +
    "===\nMSG: std_msgs/Header\n" + HEADER + "===\nMSG: builtin_interfaces/Time\n" + TIME,
  "std_msgs/msg/String": "string data\n",
  "tf2_msgs/msg/TFMessage":
    "geometry_msgs/TransformStamped[] transforms\n" +
    "===\nMSG: geometry_msgs/TransformStamped\nstd_msgs/Header header\nstring child_frame_id\n" +
    "geometry_msgs/Transform transform\n" +
    "===\nMSG: geometry_msgs/Transform\ngeometry_msgs/Vector3 translation\ngeometry_msgs/Quaternion rotation\n" +
    "===\nMSG: geometry_msgs/Vector3\nfloat64 x\nfloat64 y\nfloat64 z\n" +
    "===\nMSG: geometry_msgs/Quaternion\nfloat64 x\nfloat64 y\nfloat64 z\nfloat64 w\n" +
    "===\nMSG: std_msgs/Header\n" + HEADER + "===\nMSG: builtin_interfaces/Time\n" + TIME,
};
const writers = Object.fromEntries(
  Object.entries(definitions).map(([type, text]) => [
    type, new MessageWriter(parse(text, { ros2: true })),
  ]),
);

// 10 joint states at 50 Hz, the hand's pose at 100 Hz without its message 7, and topics that are not read. In `transforms`,
// the poses are those of frame cameras/LHAND in frame cameras, among links of a robot that stands in the room.
const START = 1700000000n * 1000000000n;
const stamp = (ns) => ({ sec: Number(ns / 1000000000n), nanosec: Number(ns % 1000000000n) });
const messages = [], transforms = [];
const add = (to, topic, type, ns, content) =>
  to.push({ topic, type, ns, data: writers[type].writeMessage(content) });
const transform = (ns, parent, child, [x, y, z], [qx, qy, qz, qw]) => ({
  header: { stamp: stamp(ns), frame_id: parent }, child_frame_id: child,
  transform: { translation: { x, y, z }, rotation: { x: qx, y: qy, z: qz, w: qw } },
});
const TF = "tf2_msgs/msg/TFMessage", TURN = [0, 0, Math.SQRT1_2, Math.SQRT1_2];
add(transforms, "/tf_static", TF, START, { transforms: [
  transform(START, "room", "cameras", [10, 20, 30], TURN),
  transform(START, "cameras/LHAND", "tool", [0, 0, 0.25], TURN)] });
for (let i = 0; i < 20; ++i) {
  const ns = START + BigInt(i) * 10000000n;
  if (i % 2 === 0) {
    const state = {
      header: { stamp: stamp(ns), frame_id: "odd" }, name: ["elbow", "wrist"],
      position: [0.125 * i, -0.5 * i], velocity: [], effort: i === 4 ? [] : [i, NaN],
    };
    add(messages, "/joint_states", "sensor_msgs/msg/JointState", ns, state);
    add(transforms, "/joint_states", "sensor_msgs/msg/JointState", ns, state);
  }
  if (i !== 7) {
    add(messages, "/mocap/LHAND/pose", "geometry_msgs/msg/PoseStamped", ns, {
      header: { stamp: stamp(ns), frame_id: "world" },
      pose: { position: { x: 1 + 0.01 * i, y: -2, z: 0.5 },
              orientation: { x: 0, y: 0, z: Math.SQRT1_2, w: Math.SQRT1_2 } },
    });
  }
  add(transforms, "/tf", TF, ns, { transforms: [
    transform(ns, "room", "base_link", [0.1 * i, 0, 0], [0, 0, 0, 1]),
    transform(ns, "base_link", "elbow_link", [0, 0, 1], [0, 0, 0, 1]),
    ...(i === 7 ? [] : [transform(ns, "cameras", "cameras/LHAND", [1 + 0.01 * i, -2, 0.5], TURN)])] });
  add(messages, "/chatter", "std_msgs/msg/String", ns, { data: "hello ".repeat(20) + i });
}

const compressors = {
  lz4: "import lz4.frame,sys;sys.stdout.buffer.write(lz4.frame.compress(sys.stdin.buffer.read()))",
  zstd: "import zstandard,sys;sys.stdout.buffer.write(zstandard.compress(sys.stdin.buffer.read()))",
};
const write = async (messages, compression, name) => {
  const file = new TempBuffer();
  const mcap = new McapWriter({
    writable: file, chunkSize: 2000, useChunks: true,
    compressChunk: compression === "none" ? undefined : (data) => ({
      compression,
      compressedData: spawnSync("/usr/bin/python3", ["-c", compressors[compression]], { input: data }).stdout,
    }),
  });
  await mcap.start({ profile: "ros2", library: "test" });
  const channels = new Map();
  for (const [sequence, { topic, type, ns, data }] of messages.entries()) {
    if (!channels.has(topic)) {
      const schemaId = await mcap.registerSchema({
        name: type, encoding: "ros2msg", data: new TextEncoder().encode(definitions[type]),
      });
      channels.set(topic, await mcap.registerChannel({
        schemaId, topic, messageEncoding: "cdr", metadata: new Map(),
      }));
    }
    await mcap.addMessage({
      channelId: channels.get(topic), sequence, publishTime: ns, logTime: ns + 3000000n, data,
    });
  }
  await mcap.end();
  writeFileSync(name, file.get());
};
for (const compression of ["none", "lz4", "zstd"]) await write(messages, compression, `bag_${compression}.mcap`);
await write(transforms, "none", "tf.mcap");
for (const [name, list] of Object.entries({ messages, transforms })) {
  writeFileSync(`/tmp/${name}.json`, JSON.stringify(
    list.map(({ topic, type, ns, data }) => ({
      topic, type, ns: ns.toString(), data: Buffer.from(data).toString("hex") }))));
}
