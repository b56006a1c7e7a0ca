// SPDX-License-Identifier: Apache-2.0
import {differences, floats, inflated} from './binary.js';

const MOST_MOVED = 0.35;  // m or rad: larger displacements are not exaggerated

/** Number of the picture at a time or the last before it. */
export function pictureAt(times, time) {
  let low = 0;
  let high = times.length - 1;
  while (low < high) {
    const middle = Math.ceil((low + high) / 2);
    if (times[middle] <= time) low = middle; else high = middle - 1;
  }
  return low;
}

/** A robot that executed the plan: pictures of its displacements from the plan, as the program packed them. */
class PlayedRobot {
  constructor(packed, links, values, unitM, unitRad) {
    Object.assign(this, {as: packed.as, stabilised: packed.stabilised, pictures: packed.pictures, tips: packed.tips ?? []});
    this.width = 6 * links;
    this.values = values;
    this.units = [unitM, unitM, unitM, unitRad, unitRad, unitRad];
  }

  /** Its last picture up to i. A robot that fell stays where it lay. */
  last(i) {
    return Math.min(i, this.pictures - 1);
  }

  /** Displacement of a link in picture i: x, y, z in m, then a rotation vector in rad. */
  displacement(i, link) {
    const from = this.width * this.last(i) + 6 * link;
    return this.units.map((unit, k) => unit * this.values[from + k]);
  }

  /** The wanted factor, or the largest that keeps the exaggerated robot in one piece. */
  factor(i, wanted) {
    let largest = 0;
    const from = this.width * this.last(i);
    for (let k = 0; k < this.width; ++k) largest = Math.max(largest, this.units[k % 6] * Math.abs(this.values[from + k]));
    return Math.max(1, Math.min(wanted, largest > 0 ? MOST_MOVED / largest : wanted));
  }

  /** Largest distance from the plan, mm, over all places of a kind in picture i; null if all of them stand. */
  distance(i, place) {
    const known = this.tips.filter((tip) => tip.place === place).map((tip) => tip.distance_mm[this.last(i)]).filter((mm) => typeof mm === 'number');
    return known.length > 0 ? Math.max(...known) : null;
  }
}

/** Robots of a playback that have pictures; none if nothing was recorded. */
export const playedRobots = (playback) => playback?.time_s?.length > 0 ? (playback.robots ?? []).filter((robot) => robot.pictures > 0) : [];

/** Decodes `deployment.playback`: the pictures of the plan, and those of each robot. */
export async function readPlayback(playback) {
  const {time_s: times, joints, links} = playback;
  const root = floats(playback.root);
  const n = joints.length;
  const q = differences(await inflated(playback.q), n, times.length);
  const robots = await Promise.all(playedRobots(playback).map(async (robot) => new PlayedRobot(robot, links.length,
    differences(await inflated(robot.displacement), 6 * links.length, robot.pictures), playback.unit_m, playback.unit_rad)));
  return {
    times, joints, links, robots,
    posture: (i) => Array.from(q.subarray(n * i, n * (i + 1)), (x) => playback.unit_rad * x),
    root: (i) => ({position: Array.from(root.subarray(7 * i, 7 * i + 3)), quaternion: Array.from(root.subarray(7 * i + 3, 7 * i + 7))}),
  };
}

/** Distances of all robots as rows: `as`, time, and the tips in order. */
export function distanceRows(playback) {
  const times = playback.time_s;
  return playedRobots(playback).flatMap((robot) => Array.from({length: robot.pictures}, (_, i) => [robot.as, times[i], ...robot.tips.map((tip) => tip.distance_mm[i])]));
}
