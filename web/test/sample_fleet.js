// SPDX-License-Identifier: Apache-2.0
// Data of a fleet's page, made by hand: twelve robots of two batches. One is unlike the others, and one drifts.
import {EVIL} from './sample_robot.js';

const session = (robot, number, batch, day, more = {}) => ({
  name: `${robot}_${number}`, robot, batch, day, exit_code: 0, status: 'converged', postures: 60,
  uncalibrated_mm: 6.2, urdf_mm: 0.8, compensated_mm: 0.5, seconds: 5.5, ...more,
});

export function sampleFleet() {
  const robots = Array.from({length: 10}, (_, i) => `talos_${i + 1}`);
  const sessions = [
    ...robots.map((robot, i) => session(robot, 1, i < 5 ? 'A' : 'B', 0, {urdf_mm: 0.7 + 0.01 * i})),
    session('talos_2', 3, 'A', 90, {urdf_mm: 1.1}), session('talos_2', 2, 'A', 40, {urdf_mm: 0.9}),
    session('talos_7', 2, 'B', 60, {urdf_mm: 4.4}),
    session(EVIL, 1, 'B', 3, {exit_code: 4, status: 'refused', urdf_mm: 9.1}),
    session('talos_12', 1, 'A', 5, {exit_code: 3, status: 'not done', postures: 0, uncalibrated_mm: null, urdf_mm: null, compensated_mm: null}),
  ];
  return {
    format: 'elastocal-fleet-1', version: '0.0.0', prior: true, sessions,
    fleet: {
      sessions: sessions.length, not_deployable: 2, robots: 10, median_urdf_rmse_3d_mm: 0.75, workshop: ['talos_7'],
      out_of_family: [{parameter: 'arm_3_joint.theta', unit: 'rad', p_adjusted: 2e-7, robot: 'talos_7', value: 0.035, family: 0.001, sd: 0.004}],
      batches: [{parameter: 'leg_2_joint.r', unit: 'm', p_adjusted: 0.003, batch: 'B', difference: 0.0012, sd: 0.0002}],
      drifts: [{parameter: 'arm_1_joint.theta', unit: 'rad', p_adjusted: 1e-5, robot: 'talos_2', per_day: 5e-5, sd: 4e-6,
                sessions: [{day: 0, value: 0.001, sd: 2e-4}, {day: 90, value: 0.0056, sd: 2e-4}, {day: 40, value: 0.0031, sd: 2e-4}]}],
      notes: [`${EVIL}_1: of another nominal robot than most, not in the family`],
    },
    family: Array.from({length: 30}, (_, i) => ({parameter: `joint_${i}.theta`, unit: 'rad', mean: 1e-3 * (i - 15), sd: 4e-3, robots: 10})),
  };
}
