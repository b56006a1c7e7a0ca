// SPDX-License-Identifier: Apache-2.0
import {toCsv} from '../lib/csv.js';
import {figure, section} from '../lib/figure.js';
import {fixed} from '../lib/format.js';
import {table} from '../lib/table.js';
import {playbackFigure} from './playback.js';

const PLACES = [['Hands', 'hands'], ['Swinging feet', 'swinging_feet'], ['Waist', 'waist']];
const KNOWS = {nominal: 'the nominal URDF', urdf: 'the calibrated URDF', compensated: 'geometry and elasticity'};

const place = (error) => error?.samples ? `${fixed(error.rms_mm)} (${fixed(error.max_mm)})` : '';

/** Execution of a motion by controllers with different knowledge of the robot (`simulate --deploy`). */
export function deploymentSection(report) {
  const runs = report.deployment?.executions;
  if (!Array.isArray(runs) || runs.length === 0) return null;
  return section('deployment', 'On the robot', 'The calibration put to use',
    'A virtual robot with the errors of the one that was calibrated executes a planned motion. Distances from the plan in millimetres: root mean square, and the largest in brackets.',
    playbackFigure(report, (robot) => KNOWS[robot.as] ?? robot.as),
    figure({title: 'Distance from the plan', body: table({caption: 'Distance from the plan',
      columns: [{text: 'The controller knows'}, {text: 'Stabiliser'}, {text: 'Stood'},
        ...PLACES.map(([text]) => ({text, unit: 'mm', number: true})),
        {text: 'Landing', unit: 'mm, deg', number: true},
        {text: 'Stabiliser\u2019s shift', unit: 'mm', number: true}],
      rows: runs.map((run) => [KNOWS[run.as] ?? run.as, run.stabilised ? 'yes' : 'no',
        run.refused ? 'not played' : run.stood ? 'yes' : `fell at ${fixed(run.time_s, 0)} s`, ...PLACES.map(([, key]) => place(run[key])),
        run.landing?.samples ? `${fixed(run.landing.max_mm)}, ${fixed(run.landing.max_deg)}` : '',
        run.stabilised ? fixed(run.stabiliser_largest_shift_mm, 1) : ''])}),
    data: {name: 'deployment.csv', text: () => toCsv(['as', 'stabilised', 'stood', ...PLACES.flatMap(([, key]) => [`${key}_rms_mm`, `${key}_max_mm`])],
      runs.map((run) => [run.as, run.stabilised, run.stood, ...PLACES.flatMap(([, key]) => [run[key]?.rms_mm, run[key]?.max_mm])]))}}));
}
