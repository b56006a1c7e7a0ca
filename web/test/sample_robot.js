// SPDX-License-Identifier: Apache-2.0
// A little robot of five joints, as a URDF and as numbers, for reports made by hand.

export const EVIL = '<script>alert(1)</script>';

/** [name, parent link, child link, origin, axis] */
const JOINTS = [
  ['leg_1_joint', 'base_link', 'thigh', [0, 0.1, -0.1], 'x'],
  ['leg_2_joint', 'thigh', 'shank', [0, 0, -0.4], 'y'],
  ['arm_1_joint', 'base_link', 'upper_arm', [0, -0.2, 0.4], 'y'],
  ['arm_2_joint', 'upper_arm', 'forearm', [0, 0, -0.3], 'y'],
  [EVIL, 'base_link', 'head', [0, 0, 0.5], 'z'],
];
const SHAPES = {
  base_link: '<box size="0.2 0.3 0.8"/>', thigh: '<cylinder radius="0.06" length="0.3"/>',
  shank: '<cylinder radius="0.05" length="0.3"/>', upper_arm: '<box size="0.08 0.08 0.25"/>',
  forearm: '<mesh filename="meshes/forearm.stl" scale="2 2 2"/>', head: '<sphere radius="0.1"/>',
};
const MARKERS = [
  ['WAIST_1', 'base_link', [-0.1, 0.1, 0], 'WAIST'], ['WAIST_2', 'base_link', [-0.1, -0.1, 0.1], 'WAIST'],
  ['HAND_1', 'forearm', [0.05, 0, -0.2], 'HAND'], ['HAND_2', 'forearm', [-0.05, 0, -0.25], 'HAND'],
  ['KNEE_1', 'shank', [0.05, 0.02, -0.1], 'KNEE'], ['KNEE_2', 'shank', [0.05, -0.02, -0.2], 'KNEE'],
  [EVIL, 'head', [0.1, 0, 0.1], EVIL],
];
/** A tetrahedron 0.15 m high as binary STL. */
export function stl() {
  const corners = [[0.04, 0, 0.07], [-0.02, 0.035, 0.07], [-0.02, -0.035, 0.07], [0, 0, -0.08]];
  const faces = [[0, 1, 2], [0, 3, 1], [1, 3, 2], [2, 3, 0]];
  const bytes = Buffer.alloc(84 + 50 * faces.length);
  bytes.writeUInt32LE(faces.length, 80);
  faces.forEach((face, f) => face.forEach((corner, c) => corners[corner].forEach((x, k) =>
    bytes.writeFloatLE(x, 84 + 50 * f + 12 * (c + 1) + 4 * k))));
  return bytes.toString('base64');
}

const AXES = {x: [1, 2], y: [2, 0], z: [0, 1]};

const xml = (text) => text.replaceAll('&', '&amp;').replaceAll('<', '&lt;').replaceAll('"', '&quot;');

export const joints = JOINTS.map(([name]) => name);
export const markers = MARKERS.map(([name, link, , cluster]) => ({name, link, cluster}));

export function urdf() {
  const unit = {x: '1 0 0', y: '0 1 0', z: '0 0 1'};
  const links = Object.entries(SHAPES).map(([name, shape]) => `<link name="${name}"><visual>
    <origin xyz="0 0 ${name === 'base_link' || name === 'head' ? 0.1 : -0.15}"/><geometry>${shape}</geometry></visual></link>`);
  const movable = JOINTS.map(([name, parent, child, xyz, axis]) => `<joint name="${xml(name)}" type="revolute">
    <parent link="${parent}"/><child link="${child}"/><origin xyz="${xyz.join(' ')}"/><axis xyz="${unit[axis]}"/>
    <limit lower="-2" upper="2" velocity="1" effort="50"/></joint>`);
  return `<robot name="sample">${links.join('')}
    <link name="sole"/><joint name="sole_joint" type="fixed"><parent link="shank"/><child link="sole"/><origin xyz="0 0 -0.4"/></joint>
    ${movable.join('')}</robot>`;
}

/** Transforms a point of a link to the root link, joint by joint. */
function toRoot(link, point, q) {
  const index = JOINTS.findIndex(([, , child]) => child === link);
  if (index < 0) return point;
  const [, parent, , xyz, axis] = JOINTS[index];
  const [a, b] = AXES[axis];
  const turned = [...point];
  turned[a] = Math.cos(q[index]) * point[a] - Math.sin(q[index]) * point[b];
  turned[b] = Math.sin(q[index]) * point[a] + Math.cos(q[index]) * point[b];
  return toRoot(parent, turned.map((x, k) => x + xyz[k]), q);
}

export const WAIST = [0.3, -0.2, 0.9];

/** x, y, z of all markers in the room for joint positions q. */
export const markerPositions = (q) =>
  MARKERS.flatMap(([, link, point]) => toRoot(link, point, q).map((x, k) => x + WAIST[k]));
