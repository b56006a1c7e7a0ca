import {toCsv} from '../lib/csv.js';
import {h} from '../lib/dom.js';
import {choice, figure, section} from '../lib/figure.js';
import {fixed, significant} from '../lib/format.js';
import {byJoint, family, kindsOf, STATUS_WORDS} from '../lib/parameters.js';
import {table} from '../lib/table.js';
import {stiffness, userUnit} from '../lib/units.js';

const pretty = (joint) => joint.replace(/_joint$/, '').replaceAll('_', ' ');

/** One parameter: value and standard deviation; greyed where it is held. */
export function valueCell(parameter) {
  if (!parameter) return '';
  const {unit, factor, digits} = userUnit(parameter.unit);
  const words = `${parameter.name}: ${STATUS_WORDS[parameter.status] ?? parameter.status}`;
  if (parameter.status !== 'estimated') {
    const short = {dropped: '·', not_in_model: '–', held: 'held'}[parameter.status] ?? '0';
    return h('span', {class: 'held', title: words, 'data-parameter': parameter.name}, short,
             h('span', {class: 'sr-only'}, ` ${STATUS_WORDS[parameter.status] ?? ''}`));
  }
  const value = parameter.value * factor;
  const sd = parameter.sd === null ? '' : `±${fixed(parameter.sd * factor, digits).replace(/^0(?=\.)/, '')}`;
  const k = stiffness(parameter);
  return h('span', {class: parameter.significant ? 'estimate significant' : 'estimate',
                    title: `${words}; ${significant(value, 6)} ± ${significant(parameter.sd * factor)} ${unit}` +
                      (k ? `; stiffness ${significant(k.value)} ${k.unit}` : ''),
                    'data-parameter': parameter.name, 'data-value': parameter.value},
           h('span', {class: 'value'}, fixed(value, digits)), h('span', {class: 'sd'}, sd));
}

function geometryTable(joints, shown) {
  const kinds = kindsOf(joints).filter(({kind}) => !kind.startsWith('compliance'));
  const unitOf = (kind) => userUnit([...joints.values()].find((j) => j.has(kind)).get(kind).unit).unit;
  const columns = [{text: 'Joint'}, ...kinds.map(({kind, symbol, what}) => ({
    text: h('abbr', {title: what}, symbol), unit: unitOf(kind), number: true}))];
  const rows = [...joints].filter(([joint]) => shown(joint)).map(([joint, parameters]) =>
    [h('span', {title: joint}, pretty(joint)), ...kinds.map(({kind}) => valueCell(parameters.get(kind)))]);
  return table({caption: 'Geometric errors of the joints: value and standard deviation', columns, rows, className: 'table1'});
}

/** The stiffness that a compliance means, where it is told from a rigid joint. */
function stiffnessCell(parameter) {
  const k = parameter?.significant ? stiffness(parameter) : null;
  if (!k) return '';
  const ends = [1, -1].map((sign) => stiffness({...parameter, value: parameter.value + sign * 1.96 * parameter.sd}));
  const text = ends.map((end) => end ? significant(end.value) : '∞').join(' to ');
  return h('span', {title: `95 %: ${text} ${k.unit}`}, significant(k.value));
}

function elasticTable(joints, shown) {
  const kinds = kindsOf(joints).filter(({kind}) => kind.startsWith('compliance'));
  const columns = [{text: 'Joint'}, ...kinds.flatMap(({symbol, what}) => [
    {text: h('abbr', {title: what}, symbol), unit: 'µrad/(N·m)', number: true},
    {text: h('abbr', {title: `stiffness: inverse of the ${what}`}, symbol.replace('c', 'K')), unit: 'N·m/rad', number: true}])];
  const rows = [...joints].filter(([joint]) => shown(joint)).map(([joint, parameters]) =>
    [h('span', {title: joint}, pretty(joint)), ...kinds.flatMap(({kind}) => [valueCell(parameters.get(kind)), stiffnessCell(parameters.get(kind))])]);
  return table({caption: 'Compliance and stiffness of the joints', columns, rows, className: 'table1'});
}

/** Chains of which Table 1 can show one at a time; without them, the joints’ first words. */
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

function legsTable(parameters, legs) {
  const axes = ['x', 'y', 'z', 'rx', 'ry', 'rz'];
  const of = (leg, axis) => parameters.find((p) => p.name === `${leg.name}.compliance_${axis}`);
  const cell = (leg, axis, i) => {
    const parameter = of(leg, axis);
    const text = significant(leg.stiffness[i]);
    if (parameter?.status === 'estimated') return text;
    return h('span', {class: 'held', title: STATUS_WORDS[parameter?.status] ?? 'not in this model'}, text);
  };
  return figure({
    title: 'Stiffness of the legs, as felt at the waist',
    note: 'The whole leg between foot and waist, in the axes of the foot, in the mean of its standing postures. Greyed: its own term was not supported by the data, what is left comes from the joints.',
    body: table({caption: 'Stiffness of the legs',
      columns: [{text: 'Leg'}, ...axes.map((a, i) => ({text: `K ${a}`, unit: i < 3 ? 'N/mm' : 'N·m/rad', number: true}))],
      rows: legs.map((leg) => [leg.name.replaceAll('_', ' '), ...axes.map((a, i) => cell(leg, a, i))])}),
    data: {name: 'leg_stiffness.csv', text: () => toCsv(['leg', ...axes.map((a, i) => `K_${a}_${i < 3 ? 'N_per_mm' : 'Nm_per_rad'}`)], legs.map((leg) => [leg.name, ...leg.stiffness]))},
  });
}

/** Waist and markers: of the experiment, not of the robot; folded away. */
function externals(parameters, legNames) {
  const rows = parameters.filter((p) => ['marker', 'waist'].includes(family(p, legNames)));
  if (rows.length === 0) return null;
  return h('details', {class: 'fold'}, h('summary', {}, `Waist and marker positions (${rows.length} parameters, fitted anew for every recording)`),
    table({caption: 'Waist and marker positions',
      columns: [{text: 'Parameter'}, {text: 'Deviation', number: true}, {text: 'sd', number: true}, {text: 'Unit'}],
      rows: rows.map((p) => {
        const {unit, factor, digits} = userUnit(p.unit);
        return {class: p.status === 'estimated' ? '' : 'held',
                cells: [p.name, fixed(p.value * factor, digits), p.sd === null ? '–' : fixed(p.sd * factor, digits), unit]};
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
  const holders = [geometryTable, elastic && elasticTable].filter(Boolean).map((make) => ({make, at: h('div', {}, make(joints, () => true))}));
  const choose = (name) => {
    const chain = chains.find((c) => c.name === name);
    for (const {make, at} of holders) at.replaceChildren(make(joints, (joint) => !chain || chain.joints.has(joint)));
  };
  const filter = chains.length > 1 && choice('Chain', [{value: '', text: 'All chains'},
    ...chains.map((c) => ({value: c.name, text: c.name.replaceAll('_', ' ')}))], '', choose);
  return section('parameters', 'Errors', 'Errors of the robot',
    'What differs from the nominal robot: estimate and standard deviation. Bold: the 95 % interval excludes nominal. Grey: held at nominal.',
    filter, figure({
      title: 'Geometry',
      note: 'A dot: cannot be told from other parameters of the chain and is counted there. 0: the data say hardly more than the prior. Point at a value for more digits.',
      body: holders[0].at, data: {name: 'parameters.csv', text: () => csv(summary.parameters)},
    }), elastic && figure({
      title: 'Elasticity',
      note: 'How far a joint gives way about its axis (z) and across it (x, y); the stiffness where the 95 % interval excludes a rigid joint.',
      body: holders[1].at, data: {name: 'elasticity.csv', text: () => csv(summary.parameters.filter((p) => /\.compliance_/.test(p.name)))},
    }), legs.length > 0 && legsTable(summary.parameters, legs), externals(summary.parameters, legNames));
}
