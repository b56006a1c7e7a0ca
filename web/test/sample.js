// SPDX-License-Identifier: Apache-2.0
// A report made by hand. Every section has data, and some names are HTML.
import {deflateSync} from 'node:zlib';

import {EVIL, joints, markerPositions, markers, stl, urdf, WAIST} from './sample_robot.js';

const float32 = (values) => Buffer.from(new Float32Array(values).buffer).toString('base64');
const MODELS = ['uncalibrated', 'offsets_only', 'geometric', 'full'];
const ERRORS_MM = [8.17, 4.39, 2.45, 0.29];

// A fixed sequence of numbers in [-1, 1), so that every sample is the same.
let state = 1;
const noise = () => {
  state = (state * 48271) % 2147483647;
  return 2 * state / 2147483647 - 1;
};

const posture = (i) => joints.map((_, k) => 0.7 * Math.sin(0.9 * i + 1.7 * k));

function scene(name, kind, count, step) {
  const times = Array.from({length: count}, (_, i) => step * i);
  const qs = times.map((_, i) => posture(kind === 'sine' ? 0.05 * i : i));
  const measured = qs.flatMap((q, i) => markerPositions(q).map((x, k) => i === 1 && k < 3 ? NaN : x));
  const off = (mm) => float32(measured.map((x) => x + 1e-3 * mm * noise()));
  return {
    name, kind, total: 10 * count, support: ['sole'], markers: markers.map((_, i) => i), time_s: times, q: float32(qs.flat()),
    waist: float32(qs.flatMap(() => [...WAIST, 0, 0, 0, 1])), measured: float32(measured),
    predicted: {uncalibrated: off(ERRORS_MM[0]), full: off(ERRORS_MM[3])},
  };
}

const byModel = (factor) => Object.fromEntries(MODELS.map((m, i) => [m, factor * ERRORS_MM[i]]));

function parameters() {
  const one = (name, unit, value, sd, status = 'estimated') => ({name, unit, value, sd, status, significant: status === 'estimated' && Math.abs(value) > 2 * sd});
  return [
    one('waist.T0.r', 'm', 0.001, 0.0001),
    ...joints.flatMap((joint, i) => [
      one(`${joint}.theta`, 'rad', 0.012 * (i - 2), 0.0004), one(`${joint}.r`, 'm', 0.0011 * (i - 1), 0.00008),
      one(`${joint}.d`, 'm', 0, null, 'dropped'), one(`${joint}.alpha`, 'rad', 0, 0.008, i % 2 ? 'unsupported' : 'held'),
      one(`${joint}.compliance_z`, 'rad/(N.m)', 2.5e-5 * (i + 1), 1e-6),
    ]),
    one('leg_left.compliance_z', 'm/N', 5.5e-6, 1e-7),
    ...markers.map((m) => one(`marker.${m.name}.x`, 'm', 0.002, 0.0001)),
  ];
}

export function sampleSummary() {
  return {
    status: 'converged', message: '', settled: true, objections: [],
    remarks: [`Marker ${EVIL} was seen in 3 of 24 postures only`],
    robot: `sample ${EVIL}`, recording: `day "1" ${EVIL}`, postures: 24, markers: markers.length,
    parameters_total: 34, identifiable: 309, identifiable_theory: 309, equations: 500, marker_sd_mm: 0.021,
    rmse_3d_mm: byModel(1), rmse_coordinate_mm: byModel(0.577), max_mm: byModel(3),
    held_out_rmse_3d_mm: byModel(1.1), kfold: {folds: 5, rmse_3d_mm: byModel(1.2), max_mm: byModel(3.1)},
    legs: [{name: 'leg_left', stiffness: [57.7, 75.3, 186, 24700, 5230, null],
      interval_95: [[33, null], [32, null], [181.5, 190.2], [22500, 26800], [5190, 5270], [null, null]],
      known: [false, false, true, true, true, false]}],
    soles: [{leg: 'leg_left', changes: 3, compliance_um_per_n: 0.742, sd_um_per_n: 0.041, most_um_per_n: 0.831, told: true},
      {leg: 'leg_right', changes: 0, compliance_um_per_n: null, sd_um_per_n: null, most_um_per_n: null, told: false}],
    outliers: [{posture: 3, marker: EVIL, residual_mm: 12.3, normalised: 8.1}],
    trials: [{name: EVIL, chains: ['leg'], used: true, postures: 24, samples: 192, clock: {lag_s: 2.1}, findings: ['a finding']}],
    excitation: {condition_base: 84.2, O1: 0.793, hardly_excited: ['leg_1_joint.r']},
    diagnosis: ['3 of 44 causes together take the held-out error from 0.60 to 0.40 mm (nested folds):'], diagnosis_pictures: samplePictures(),
    warnings: ['cluster HAND: was it knocked?', ...Array.from({length: 9}, (_, i) => `joint "arm_${i + 1}_joint" is at 1.${i} rad, 0.5 degrees beyond its limit of 1 rad`)], parameters: parameters(),
    correlations: [{first: 'leg_1_joint.theta', second: 'leg_2_joint.theta', coefficient: -0.97}],
  };
}

function sampleData() {
  const rate = 100;
  const filtered = Array.from({length: 2000}, (_, i) => 0.4 + 0.1 * Math.tanh(3 * Math.sin(i / 160)));
  const counts = (peak) => Array.from({length: 20}, (_, i) => Math.round(200 * Math.exp(-(((i - peak) / 3) ** 2))));
  const row = (chain, motion, factor) => ({chain, case: motion, trials: 1, rmse_3d_mm: byModel(factor), max_mm: byModel(3 * factor)});
  return {
    format: 'elastocal-report-data-1', models: MODELS,
    robot: {name: 'sample', urdf: urdf(), coordinates: joints, meshes: {'meshes/forearm.stl': stl()}},
    chains: [{name: 'leg', joints: ['leg_1_joint', 'leg_2_joint']}, {name: EVIL, joints: ['arm_1_joint', 'arm_2_joint', EVIL]}],
    markers, clusters: ['WAIST', 'HAND', 'KNEE', EVIL].map((name, i) => ({name, link: 'base_link', rmse_3d_mm: byModel(0.4 + 0.3 * i)})),
    clusters_on: 'on motions that took no part in the estimate',
    spheres: [{link: 'shank', centre_m: [0, 0, -0.2], radius_m: 0.1}],
    workspaces: [{chain: 'arm', link: 'base_link', min_m: [0, -0.5, 0], max_m: [0.5, 0, 0.5]}],
    scenes: [scene(`leg ${EVIL}`, 'calibration', 24, 5), scene('leg_sine', 'sine', 100, 0.2)],
    error_table: {rows: [row(`leg ${EVIL}`, 'SW', 1), row('arm', 'RP', 1.2), row('arm', 'RM', 0.9)], chains: [row('leg', '', 1), row('arm', '', 1.05)], mean_rmse_3d_mm: byModel(1.1)},
    distributions: [{name: 'calibration', edges_mm: Array.from({length: 21}, (_, i) => i), counts: Object.fromEntries(MODELS.map((m, i) => [m, counts(ERRORS_MM[i])]))},
                    {name: 'held out', edges_mm: Array.from({length: 21}, (_, i) => i), counts: Object.fromEntries(MODELS.map((m, i) => [m, counts(ERRORS_MM[i] + 1)]))}],
    traces: [{trial: 'leg_sine', kind: 'sine', group: 'leg', time_s: Array.from({length: 100}, (_, i) => 0.2 * i), rms_mm: Object.fromEntries(MODELS.map((m, j) => [m, Array.from({length: 100}, (_, i) => ERRORS_MM[j] * (1 + 0.4 * Math.sin(i / 6)))]))}],
    signals: [{trial: `leg ${EVIL}`, marker: EVIL, axis: 'z', rate_hz: rate, threshold_mm_per_s: 2.4, raw: float32(filtered.map((x) => x + 2e-4 * noise())), filtered: float32(filtered),
               chosen: [300, 310, 320, 900, 910], rests: [[250, 420], [800, 960]]}],
  };
}

function sampleMotion() {
  const time = Array.from({length: 300}, (_, i) => 0.1 * i);
  const columns = {time, support: time.map(() => 'sole'), zmp_x: time.map((t) => 0.02 * Math.sin(t)), zmp_y: time.map((t) => 0.01 * Math.cos(t))};
  joints.forEach((joint, k) => {
    columns[joint] = time.map((t) => 0.5 * Math.sin(t + k));
    columns[`torque_${joint}`] = time.map((t) => 20 * Math.cos(t + k));
  });
  return {name: 'motion', rows: 3000, columns, margins: {sets: [{name: 'leg', left_out: [{posture: 2, reason: EVIL}]}], margins: {zmp_m: 0.0214, torque_share: 0.31, spheres: `a and ${EVIL}`}}};
}

/** Pictures of three causes, driven by a joint's position, by the direction of its motion, and by time. */
function samplePictures() {
  const of = (name, against, unit, xs, curve, curveX) => ({
    name, words: `${name}: 1.2 +- 0.1 mrad`, p_adjusted: 2e-5, against, against_unit: unit, displaced: `displacement of ${name.split('.')[0]}`, unit: 'mrad',
    postures: xs.map((_, i) => i), x: xs, y: xs.map((x) => curve(x) + 0.2 * noise()), sd: xs.map(() => 0.2), curve_x: curveX, curve_y: curveX.map(curve),
  });
  const line = (from, to) => Array.from({length: 81}, (_, i) => from + (to - from) * i / 80);
  return [of('arm_1_joint.eccentricity', 'position of arm_1_joint', 'deg', Array.from({length: 60}, () => 90 * noise()), (x) => 1.2 * Math.sin(x * Math.PI / 180), line(-90, 90)),
          of(`${EVIL}.hysteresis`, `direction in which ${EVIL} last moved`, '', Array.from({length: 60}, (_, i) => i % 2 ? 1 : -1), (x) => 0.8 * x, line(-1, 1)),
          of('waist.drift', 'time', 'h', Array.from({length: 60}, (_, i) => i / 30), (x) => 0.5 * (x - 1), line(0, 2))];
}

/** Packs displacements like the program: one byte for each difference between pictures, then deflated. */
function packed(pictures) {
  const flat = pictures.flatMap((picture, i) => picture.map((x, k) => x - (i > 0 ? pictures[i - 1][k] : 0)));
  return deflateSync(Buffer.from(Int8Array.from(flat).buffer)).toString('base64');
}

/** Two robots that execute a motion of 40 pictures; one falls after 25. */
function sampleDeployment() {
  const pictures = 40;
  const times = Array.from({length: pictures}, (_, i) => 0.2 * (i + 1));
  const links = ['base_link', 'thigh', 'shank', 'upper_arm', 'forearm', 'head', 'sole'];
  const qs = times.map((t) => joints.map((_, k) => Math.round(120 * Math.sin(t / 10 + k))));
  const robot = (as, count, mm) => ({as, stabilised: true, pictures: count,
    displacement: packed(times.slice(0, count).map((t) => links.flatMap((_, k) => [Math.round(10 * mm), k, Math.round(20 * Math.sin(t)), 0, 0, k]))),
    tips: [{link: 'forearm', place: 'hand', distance_mm: times.slice(0, count).map((_, i) => mm + 0.1 * i)},
           {link: 'sole', place: 'foot', distance_mm: times.slice(0, count).map((_, i) => i < 10 ? null : mm / 2)}]});
  const error = (mm) => ({rms_mm: mm, max_mm: 2 * mm, rms_deg: 0.1, max_deg: 0.2, samples: 40});
  const run = (as, mm, stood) => ({as, stabilised: true, refused: '', stood, time_s: stood ? 8 : 5, hands: error(mm), swinging_feet: error(mm), landing: error(mm), waist: error(mm), centre_of_mass: error(mm), stabiliser_largest_shift_mm: 4});
  return {executions: [run('nominal', 12, false), run('compensated', 1.5, true)],
    playback: {time_s: times, joints, links, unit_m: 1e-4, unit_rad: 1e-4, q: packed(qs), root: float32(times.flatMap(() => [...WAIST, 0, 0, 0, 1])),
      robots: [robot('nominal', 25, 12), robot('compensated', pictures, 1.5)]}};
}

function sampleDesign() {
  const columns = {algorithm: [], chain: [], seed: [], postures: [], o1: []};
  for (const [algorithm, best] of [['NOCP', 0.795], ['COCP', 0.79], ['random', 0.66]]) {
    for (const chain of ['leg', EVIL]) for (const seed of [1, 2, 3]) for (const n of [4, 8, 12, 16, 24]) {
      columns.algorithm.push(algorithm); columns.chain.push(chain); columns.seed.push(seed); columns.postures.push(n);
      columns.o1.push(best * (1 - 1 / (n + seed)));
    }
  }
  return {curves: columns, summary: {chains: [{chain: 'leg', postures: 12, o1: 0.793, efficiency: 0.987, bound: 0.8035, time_s: 2.4}]}};
}

export function sampleReport() {
  state = 1;
  const summary = sampleSummary();
  const names = summary.parameters.filter((p) => p.status === 'estimated').map((p) => p.name);
  const lower = names.flatMap((_, i) => Array.from({length: i + 1}, (__, j) => i === j ? 100 : Math.round(60 * noise())));
  const earlier = summary.parameters.map((p) => ({...p, value: p.value + (p.name.endsWith('theta') ? 0.004 : 0)}));
  return {
    format: 'elastocal-report-1', version: '0.0.0', folder: EVIL, summary, data: sampleData(),
    correlation: {names, lower: Buffer.from(Int8Array.from(lower).buffer).toString('base64')},
    validation: {status: 'implausible', frozen: false, recording: 'another day', expected_error_mm: 0.6, mistakes: ['elbow: the sign of its positions is reversed'],
      rmse_3d_mm: {uncalibrated: 7, calibrated: 1.1, urdf: 1.9}, rmse_coordinate_mm: {uncalibrated: 4, calibrated: 0.7, urdf: 1.2}, max_mm: {uncalibrated: 20, calibrated: 3, urdf: 5}, rmse_3d_mm_all: {uncalibrated: 8, calibrated: 1.31, urdf: 2.17}},
    deployment: sampleDeployment(), design: sampleDesign(), motions: [sampleMotion()],
    calibrations: [{label: 'spring', parameters: earlier}, {label: 'now', parameters: summary.parameters}],
    comparison: {status: 'moved', moved: ['arm_1_joint'], a: {recording: 'spring'}, joints: [{joint: 'arm_1_joint', F: 120, p_adjusted: 1e-9, moved: true}, {joint: EVIL, F: 1.1, p_adjusted: 0.4, moved: false}]},
    runs: {calibrate: {command_line: `elastocal calibrate ${EVIL} -o out`, version: '0.0.0', seed: 1, inputs: [{file: 'robot.urdf', bytes: 12345, sha256: 'ab'.repeat(32)}]}},
    missing: [{what: 'Comparison with earlier calibrations', command: 'elastocal report DIR --earlier OLD'}],
  };
}

/** The built page with a report, as by the program. */
export function page(template, report) {
  const json = JSON.stringify(report).replaceAll('<', '\\u003c');
  const [before, after] = template.split('"@ELASTOCAL_REPORT_DATA@"');
  return before + json + after;
}
