// SPDX-License-Identifier: Apache-2.0
import {floats} from '../lib/binary.js';
import {kindName} from '../lib/format.js';

const POSTURES_PER_SECOND = 1.5;

/** The feet in a cell of motion.csv: links joined by '+', 'both' for all known feet, or 'none'. */
export function feet(cell, all) {
  if (cell === undefined || cell === null || cell === 'both') return all;
  return cell === 'none' ? [] : String(cell).split('+').filter(Boolean);
}

/** All feet in the column of supports or in the recorded trials. */
function knownFeet(cells, scenes) {
  const named = [...new Set(cells ?? [])].flatMap((cell) => feet(cell, []));
  return [...new Set([...named, ...scenes.flatMap((scene) => scene.support ?? [])])];
}

/** Positions of all markers, from those of the scene; NaN for the others. */
function spread(values, scene, count) {
  const all = new Float32Array(3 * count).fill(NaN);
  scene.markers.forEach((marker, k) => all.set(values.subarray(3 * k, 3 * k + 3), 3 * marker));
  return all;
}

function recordedClip(scene, data) {
  const n = data.robot.coordinates.length;
  const width = 3 * scene.markers.length;
  const frame = (values, i) => spread(values.subarray(width * i, width * (i + 1)), scene, data.markers.length);
  const [q, waist, measured] = [scene.q, scene.waist, scene.measured].map(floats);
  const predicted = Object.fromEntries(Object.entries(scene.predicted).map(([m, text]) => [m, floats(text)]));
  const moving = scene.kind === 'sine';
  return {
    name: scene.name,
    group: kindName(scene.kind),
    count: Math.floor(q.length / n),
    total: scene.total,
    markers: scene.markers.length,
    moving,
    time: scene.time_s ?? [],
    joints: data.robot.coordinates,
    at: (i) => ({
      q: q.subarray(n * i, n * (i + 1)),
      root: {position: Array.from(waist.subarray(7 * i, 7 * i + 3)), quaternion: Array.from(waist.subarray(7 * i + 3, 7 * i + 7))},
      support: scene.support ?? [],
      measured: frame(measured, i),
      predicted: (model) => predicted[model] && frame(predicted[model], i),
    }),
  };
}

function plannedClip(motion, robot, scenes) {
  const {columns} = motion;
  const joints = Object.keys(columns).filter((name) => robot.object.joints[name]);
  const time = columns.time ?? columns.t ?? [];
  const all = knownFeet(columns.support, scenes);
  const frame = (i) => ({
    q: joints.map((name) => columns[name][i]),
    root: null,
    support: feet(columns.support?.[i], all),
    zmp: columns.zmp_x ? [columns.zmp_x[i], columns.zmp_y[i]] : undefined,
  });
  const both = time.findIndex((_, i) => feet(columns.support?.[i], all).length > 1);
  return {
    name: motion.name,
    group: 'planned motion',
    count: time.length,
    total: motion.rows ?? time.length,
    markers: 0,
    moving: true,
    time,
    joints,
    standing: both < 0 ? null : frame(both),  // tells the distance of the feet
    at: frame,
  };
}

/** The posture of rest, for a project without results. */
function restClip(project, data) {
  return {
    name: 'posture of rest',
    group: 'project',
    count: 1,
    total: 1,
    markers: 0,
    moving: false,
    time: [],
    joints: data.robot.coordinates,
    at: () => ({q: project.rest, root: null, support: project.soles.map((sole) => sole.link)}),
  };
}

/** All clips for the viewer: recorded trials, then planned motions, or only the posture of rest of a project. */
export function makeClips(report, robot) {
  const recorded = (report.data?.scenes ?? []).map((scene) => recordedClip(scene, report.data));
  const planned = (report.motions ?? []).map((motion) => plannedClip(motion, robot, report.data?.scenes ?? []));
  const clips = [...recorded, ...planned].filter((clip) => clip.count > 0);
  const project = report.data?.project;
  return clips.length === 0 && project ? [restClip(project, report.data)] : clips;
}

/** Position in the clip (a real number of frames) after playing for `seconds` from `position`. */
export function advance(clip, position, seconds) {
  if (!clip.moving || clip.time.length < 2) return (position + seconds * POSTURES_PER_SECOND) % clip.count;
  const i = Math.floor(position);
  const j = Math.min(clip.count - 1, i + 1);
  const span = Math.max(1e-3, clip.time[j] - clip.time[i] || 0.1);
  // Playing does not wait during gaps in the recording.
  return (position + seconds / Math.min(span, 0.5)) % clip.count;
}
