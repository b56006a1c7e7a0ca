// SPDX-License-Identifier: Apache-2.0
import {toCsv} from '../lib/csv.js';
import {h} from '../lib/dom.js';
import {choice, figure, section} from '../lib/figure.js';
import {interval, significant, withSd} from '../lib/format.js';
import {byJoint, family, KINDS, kindsOf, splitName, STATUS_WORDS} from '../lib/parameters.js';
import {table} from '../lib/table.js';
import {stiffness, stiffnessInterval, userUnit} from '../lib/units.js';

const pretty = (joint) => joint.replace(/_joint$/, '').replaceAll('_', ' ');

/** {value, sd} of a parameter as texts in the unit that people use. */
function inUserUnit(parameter) {
  const {factor, digits} = userUnit(parameter.unit);
  return withSd(parameter.value * factor, parameter.sd === null ? null : parameter.sd * factor, digits);
}

/** Value and standard deviation of a parameter. It is grey if the recording hardly tells it, or if it is held. */
export function valueCell(parameter) {
  if (!parameter) return '';
  const {unit, factor} = userUnit(parameter.unit);
  const words = `${parameter.name}: ${STATUS_WORDS[parameter.status] ?? parameter.status}`;
  const told = parameter.status === 'estimated';
  if (!told && parameter.status !== 'unsupported') {
    const short = {not_in_model: '–', held: 'held'}[parameter.status] ?? '0';
    return h('span', {class: 'held', title: words, 'data-parameter': parameter.name}, short,
             h('span', {class: 'sr-only'}, ` ${STATUS_WORDS[parameter.status] ?? ''}`));
  }
  const value = parameter.value * factor;
  const text = inUserUnit(parameter);
  const k = stiffness(parameter);
  return h('span', {class: told ? (parameter.significant ? 'estimate significant' : 'estimate') : 'estimate held',
                    title: `${words}; ${text.value} ± ${text.sd} ${unit} (to six digits ${significant(value, 6)})` +
                      (k ? `; stiffness ${withSd(k.value, k.sd).value} ${k.unit}` : ''),
                    'data-parameter': parameter.name, 'data-value': parameter.value},
           h('span', {class: 'value'}, text.value), h('span', {class: 'sd'}, parameter.sd === null ? '' : `±${text.sd}`),
           told ? null : h('span', {class: 'sr-only'}, ` ${STATUS_WORDS[parameter.status]}`));
}

/** Explains the columns and the short marks of the table. */
function geometryNote(joints) {
  const kinds = kindsOf(joints).filter(({kind}) => !kind.startsWith('compliance'));
  const statuses = new Set([...joints.values()].flatMap((kindsOfJoint) => [...kindsOfJoint.values()].map((p) => p.status)));
  return [`${kinds.map(({symbol, what}) => `${symbol}: ${what}`).join('; ')}.`,
    statuses.has('unsupported') && ' Grey values are the most probable ones: this recording tells them hardly, or only together with others.',
    statuses.has('held') && ' “held” marks one that the project file keeps at nominal.',
    h('span', {class: 'on-screen'}, ' Point at a value to see more digits.')].filter(Boolean);
}

function geometryTable(joints, shown) {
  const kinds = kindsOf(joints).filter(({kind}) => !kind.startsWith('compliance'));
  const unitOf = (kind) => userUnit([...joints.values()].find((j) => j.has(kind)).get(kind).unit).unit;
  const columns = [{text: 'Joint'}, ...kinds.map(({kind, symbol, what}) => ({
    text: h('abbr', {title: what}, symbol), unit: unitOf(kind), number: true}))];
  const rows = [...joints].filter(([joint]) => shown(joint)).map(([joint, parameters]) =>
    [h('span', {title: joint}, pretty(joint)), ...kinds.map(({kind}) => valueCell(parameters.get(kind)))]);
  return table({caption: 'Geometric errors of the joints: value and standard deviation', columns, rows, className: 'table1 geometry'});
}

/** The stiffness for a compliance, unless the joint may be rigid. */
function stiffnessCell(parameter) {
  const k = parameter?.significant ? stiffness(parameter) : null;
  if (!k) return '';
  return h('span', {title: `95 % interval: ${interval(...stiffnessInterval(parameter))} ${k.unit}`}, withSd(k.value, k.sd).value);
}

/** The unit beside a value if it differs from the column's, for instance for a slide among turning joints. */
const ownUnit = (unit, ofColumn) => unit && unit !== ofColumn ? h('span', {class: 'sd'}, ` ${unit}`) : null;

/** The table of compliances of joints, or of the root link up to its joints. */
function elasticTable(joints, shown, {root}) {
  const kinds = kindsOf(joints).filter(({kind}) => kind.startsWith('compliance') && kind.startsWith('compliance_root') === root);
  const unit = 'µrad/(N·m)', inverse = 'N·m/rad';
  const columns = [{text: 'Joint'}, ...kinds.flatMap(({symbol, what}) => [
    {text: h('abbr', {title: what}, symbol), unit, number: true},
    {text: h('abbr', {title: `stiffness: inverse of the ${what}`}, symbol.replace('c', 'K')), unit: inverse, number: true}])];
  const cells = (parameter) => parameter ? [[valueCell(parameter), ownUnit(userUnit(parameter.unit).unit, unit)],
    [stiffnessCell(parameter), parameter.significant ? ownUnit(stiffness(parameter)?.unit, inverse) : null]] : ['', ''];
  const has = (parameters) => kinds.some(({kind}) => parameters.has(kind));
  const rows = [...joints].filter(([joint, parameters]) => shown(joint) && has(parameters)).map(([joint, parameters]) =>
    [h('span', {title: joint}, pretty(joint)), ...kinds.flatMap(({kind}) => cells(parameters.get(kind)))]);
  if (rows.length === 0) return null;
  const caption = root ? 'Compliance and stiffness of the root link up to joints on it' : 'Compliance and stiffness of the joints';
  return table({caption, columns, rows, className: 'table1'});
}

function elasticTables(joints, shown) {
  return h('div', {}, ...[false, true].map((root) => elasticTable(joints, shown, {root})).filter(Boolean));
}

/** Chains, of which Table 1 shows one at a time; without chains, the first words of the joints' names. */
export function chainsOf(report, joints) {
  const given = (report.data?.chains ?? []).map(({name, joints: own}) => ({name, joints: new Set(own)}));
  if (given.length > 0) return given.filter((chain) => joints.some((joint) => chain.joints.has(joint)));
  const groups = new Map();
  for (const joint of joints) {
    const name = joint.replace(/(_\d+)?(_joint)?$/, '');
    if (!groups.has(name)) groups.set(name, new Set());
    groups.get(name).add(joint);
  }
  return [...groups].map(([name, own]) => ({name, joints: own}));
}

function csv(parameters) {
  return toCsv(['parameter', 'unit', 'value', 'sd', 'status', 'significant'],
    parameters.map((p) => [p.name, p.unit, p.value, p.sd, p.status, String(p.significant)]));
}

function legsTable(legs) {
  const axes = ['x', 'y', 'z', 'rx', 'ry', 'rz'];
  const cell = (leg, i) => {
    const [low, high] = leg.interval_95?.[i] ?? [null, null];
    if (leg.known && !leg.known[i]) return h('span', {class: 'held'}, low === null ? 'unknown' : `unknown, > ${significant(low)}`);
    return h('span', {}, significant(leg.stiffness[i]), low === null ? null : [h('br'), h('span', {class: 'sd'}, interval(low, high))]);
  };
  return figure({
    title: 'Stiffness of the legs between foot and waist',
    note: 'Stiffness of the whole leg against forces along the axes of the foot (x, y, z) and moments about them (rx, ry, rz), in the mean of the postures in which the leg stood alone, with its 95 % interval. Unknown: the data do not tell it from a rigid leg.',
    body: table({caption: 'Stiffness of the legs',
      columns: [{text: 'Leg'}, ...axes.map((a, i) => ({text: `K ${a}`, unit: i < 3 ? 'N/mm' : 'N·m/rad', number: true}))],
      rows: legs.map((leg) => [leg.name.replaceAll('_', ' '), ...axes.map((a, i) => cell(leg, i))])}),
    data: {name: 'leg_stiffness.csv', text: () => toCsv(
      ['leg', ...axes.flatMap((a, i) => ['', '_low', '_high'].map((end) => `K_${a}${end}_${i < 3 ? 'N_per_mm' : 'Nm_per_rad'}`))],
      legs.map((leg) => [leg.name, ...leg.stiffness.flatMap((value, i) => [value, ...(leg.interval_95?.[i] ?? [null, null])])]))},
  });
}

/** The springs between the markers of a foot and the floor; null if no leg stood. */
function solesTable(soles) {
  if (soles.length === 0) return null;
  const cell = (sole) => {
    if (sole.told) return [significant(sole.compliance_um_per_n), h('span', {class: 'sd'}, ` ± ${significant(sole.sd_um_per_n, 2)}`)];
    return h('span', {class: 'held'}, sole.most_um_per_n === null ? 'not told' : `not told, < ${significant(sole.most_um_per_n, 2)}`);
  };
  return figure({
    title: 'Springs below the markers of the feet',
    note: 'How far the markers of a foot sink by the load on its sole, ± its standard deviation. It shows where a foot stays while its load changes: between a trial on both feet and one on that foot, without setting it down anew. The torques of both legs say how the feet share the weight.',
    body: table({caption: 'Springs below the markers of the feet',
      columns: [{text: 'Leg'}, {text: 'Compliance', unit: 'µm/N', number: true}, {text: 'Changes of load', number: true}],
      rows: soles.map((sole) => [sole.leg.replaceAll('_', ' '), cell(sole), String(sole.changes)])}),
    data: {name: 'soles.csv', text: () => toCsv(['leg', 'compliance_um_per_n', 'sd_um_per_n', 'most_um_per_n', 'told', 'changes'],
      soles.map((sole) => [sole.leg, sole.compliance_um_per_n, sole.sd_um_per_n, sole.most_um_per_n, String(sole.told), sole.changes]))},
  });
}

/** A name that narrow windows may break before the kind. */
const breakable = (name) => h('span', {}, splitName(name).owner, h('wbr'), `.${splitName(name).kind}`);

/** The causes that were estimated besides geometry and springs; null if there are none. */
function causesTable(parameters, legNames) {
  const causes = parameters.filter((p) => family(p, legNames) === 'joint' && !KINDS.some(({kind}) => kind === splitName(p.name).kind));
  if (causes.length === 0) return null;
  return figure({
    title: 'Causes beyond geometry and springs',
    note: 'A URDF has no place for them: “compensate” and the exported models at run time apply them.',
    body: table({caption: 'Causes beyond geometry and springs', className: 'table1',
      columns: [{text: 'Cause'}, {text: 'Estimate', number: true}],
      rows: causes.map((p) => [breakable(p.name), [valueCell(p), h('span', {class: 'sd'}, ` ${userUnit(p.unit).unit}`)]])}),
    data: {name: 'causes_estimated.csv', text: () => csv(causes)},
  });
}

/** Waist and markers, folded away because they belong to the experiment and not to the robot. */
function externals(parameters, legNames) {
  const rows = parameters.filter((p) => ['marker', 'waist'].includes(family(p, legNames)));
  if (rows.length === 0) return null;
  return h('details', {class: 'fold'}, h('summary', {}, `Waist and marker positions (${rows.length} parameters; they belong to the recording, not to the robot)`),
    table({caption: 'Waist and marker positions',
      columns: [{text: 'Parameter'}, {text: 'Deviation from nominal', number: true}, {text: 'Standard deviation', number: true}, {text: 'Unit'}],
      rows: rows.map((p) => {
        const {value, sd} = inUserUnit(p);
        return {class: p.status === 'estimated' ? '' : 'held', cells: [p.name, value, sd, userUnit(p.unit).unit]};
      })}));
}

/** Table 1 of the paper: errors of the joints with their uncertainty. */
export function table1Section(report) {
  const {summary} = report;
  if (!summary?.parameters?.length) return null;
  const legs = summary.legs ?? [];
  const legNames = legs.map((leg) => leg.name);
  const joints = byJoint(summary.parameters, legNames);
  if (joints.size === 0) return null;
  const chains = chainsOf(report, [...joints.keys()]);
  const elastic = summary.parameters.some((p) => /\.compliance_[xyz]$/.test(p.name) && family(p, legNames) === 'joint');
  const holders = [geometryTable, elastic && elasticTables].filter(Boolean).map((make) => ({make, at: h('div', {}, make(joints, () => true))}));
  const choose = (name) => {
    const chain = chains.find((c) => c.name === name);
    for (const {make, at} of holders) at.replaceChildren(make(joints, (joint) => !chain || chain.joints.has(joint)));
  };
  const filter = chains.length > 1 && choice('Chain', [{value: '', text: 'All chains'},
    ...chains.map((c) => ({value: c.name, text: c.name.replaceAll('_', ' ')}))], '', choose);
  return section('parameters', 'Errors', 'Errors of the robot',
    'The table shows how far each parameter of the robot is from its nominal value: the estimate ± its standard deviation. A value is bold where its 95 % interval excludes the nominal value, and grey where the recording hardly tells it.',
    filter, figure({
      title: 'Geometry',
      note: geometryNote(joints),
      body: holders[0].at, data: {name: 'parameters.csv', text: () => csv(summary.parameters)},
    }), elastic && figure({
      title: 'Elasticity',
      note: 'The compliance c says how far a joint gives way under load: c_z about its axis, c_x and c_y across it; c₀ how far the root link gives way up to a joint on it, about its own origin and axes. The inverse K of a compliance is the stiffness; it is shown where the 95 % interval of the compliance excludes a rigid joint.',
      body: holders[1].at, data: {name: 'elasticity.csv', text: () => csv(summary.parameters.filter((p) => /\.compliance_/.test(p.name)))},
    }), causesTable(summary.parameters, legNames), legs.length > 0 && legsTable(legs), solesTable(summary.soles ?? []), externals(summary.parameters, legNames));
}
