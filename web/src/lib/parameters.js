// SPDX-License-Identifier: Apache-2.0
import {userUnit} from './units.js';

/** 'arm_left_1_joint' and 'theta' for 'arm_left_1_joint.theta'. The kind follows the last dot. */
export function splitName(name) {
  const dot = name.lastIndexOf('.');
  return {owner: name.slice(0, dot), kind: name.slice(dot + 1)};
}

const MARKER = /^marker\./;
const WAIST = /^waist\.T0\./;

/** Whether a parameter belongs to the recording and not to the robot. */
export const isExternal = (name) => MARKER.test(name) || WAIST.test(name);

/** The first of `pairs`, which are sorted by strength. Pairs of waist and markers are optional. */
export function strongestPairs(pairs, withExternal, most = 8) {
  return pairs.filter((p) => withExternal || !(isExternal(p.first) || isExternal(p.second))).slice(0, most);
}

/** 'marker', 'waist', 'leg' (lumped compliance) or 'joint'. */
export function family(parameter, legs) {
  if (MARKER.test(parameter.name)) return 'marker';
  if (WAIST.test(parameter.name)) return 'waist';
  const {owner, kind} = splitName(parameter.name);
  return legs.includes(owner) && kind.startsWith('compliance') ? 'leg' : 'joint';
}

/** The columns of Table 1 in order, with the symbols of the paper. */
export const KINDS = [
  {kind: 'theta', symbol: 'θ', what: 'rotation about the joint axis (joint offset)'},
  {kind: 'r', symbol: 'r', what: 'translation along the joint axis'},
  {kind: 'd', symbol: 'd', what: 'translation along the common normal'},
  {kind: 'alpha', symbol: 'α', what: 'angle between consecutive axes'},
  {kind: 'beta', symbol: 'β', what: 'angle between parallel axes'},
  {kind: 'gamma', symbol: 'γ', what: 'rotation of the branch frame'},
  {kind: 'b', symbol: 'b', what: 'translation of the branch frame'},
  {kind: 'compliance_z', symbol: 'c_z', what: 'compliance about the axis'},
  {kind: 'compliance_x', symbol: 'c_x', what: 'compliance across the axis, x'},
  {kind: 'compliance_y', symbol: 'c_y', what: 'compliance across the axis, y'},
  {kind: 'compliance_root_x', symbol: 'c₀x', what: 'compliance of the root link up to the joint, x'},
  {kind: 'compliance_root_y', symbol: 'c₀y', what: 'compliance of the root link up to the joint, y'},
  {kind: 'compliance_root_z', symbol: 'c₀z', what: 'compliance of the root link up to the joint, z'},
  {kind: 'torque_bias', symbol: 'τ₀', what: 'bias of the torque sensor'},
  {kind: 'length', symbol: 'l', what: 'length of a rod'},
  {kind: 'zero', symbol: 'm₀', what: 'zero of a motor with a rod'},
  {kind: 'radius', symbol: 'ρ', what: 'radius of its crank'},
  {kind: 'anchor_x', symbol: 'a_x', what: 'anchor of the rod, x'},
  {kind: 'anchor_y', symbol: 'a_y', what: 'anchor of the rod, y'},
  {kind: 'anchor_z', symbol: 'a_z', what: 'anchor of the rod, z'},
  {kind: 'centre_x', symbol: 'o_x', what: 'centre of the crank, x'},
  {kind: 'centre_y', symbol: 'o_y', what: 'centre of the crank, y'},
  {kind: 'centre_z', symbol: 'o_z', what: 'centre of the crank, z'},
];

/** Joints with their parameters by kind, in the order of the file. */
export function byJoint(parameters, legs) {
  const joints = new Map();
  for (const parameter of parameters) {
    if (family(parameter, legs) !== 'joint') continue;
    const {owner, kind} = splitName(parameter.name);
    if (!joints.has(owner)) joints.set(owner, new Map());
    joints.get(owner).set(kind, parameter);
  }
  return joints;
}

/** The kinds of parameters that any of the joints has, in the order of the table. */
export function kindsOf(joints) {
  const present = new Set([...joints.values()].flatMap((kinds) => [...kinds.keys()]));
  return KINDS.filter(({kind}) => present.has(kind));
}

export const STATUS_WORDS = {
  estimated: 'estimated',
  unsupported: 'the most probable value: this recording tells it hardly, or only together with others',
  held: 'kept at nominal by the project file',
  not_in_model: 'not in this model',
};

/** Number of parameters with each status, without markers and waist. */
export function countByStatus(parameters, legs) {
  const counts = {};
  for (const parameter of parameters) {
    if (['marker', 'waist'].includes(family(parameter, legs))) continue;
    counts[parameter.status] = (counts[parameter.status] ?? 0) + 1;
  }
  return counts;
}

/** Joint offsets that at least one calibration estimated: [{joint, unit, of: [{value, sd} | null]}]. */
export function offsetsOverTime(calibrations) {
  const names = new Set(calibrations.flatMap((c) => c.parameters.filter((p) => /\.theta$/.test(p.name) && !/^waist\./.test(p.name) && p.status === 'estimated').map((p) => p.name)));
  return [...names].map((name) => {
    const of = calibrations.map((c) => c.parameters.find((p) => p.name === name && p.status === 'estimated') ?? null);
    const {unit, factor} = userUnit(of.find(Boolean).unit);
    return {joint: splitName(name).owner, unit, of: of.map((p) => p && {value: p.value * factor, sd: p.sd * factor})};
  });
}
