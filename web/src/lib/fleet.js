// SPDX-License-Identifier: Apache-2.0
// What the page of a fleet says of its robots, from the sessions and findings of a batch.

const DEPLOYABLE = 0;  // exit codes of calibrate
const REFUSED = 4;

const VERDICTS = {fine: 'to be deployed', refused: 'not to be deployed', failed: 'failed'};
export const verdictText = (verdict) => VERDICTS[verdict];

const verdictOf = ({exit_code: code}) => code === DEPLOYABLE ? 'fine' : code === REFUSED ? 'refused' : 'failed';

/** Sessions in the order of time; those without a day as they stand. */
const inTime = (sessions) => sessions.map((session, i) => ({session, i}))
  .sort((a, b) => ((a.session.day ?? -Infinity) - (b.session.day ?? -Infinity) || a.i - b.i)).map(({session}) => session);

/** How much a robot needs to be looked at: those at the top first. */
const urgency = (robot) => (robot.verdict === 'failed' ? 4 : 0) + (robot.verdict === 'refused' ? 3 : 0) + (robot.workshop ? 2 : 0) + (robot.drifts.length > 0 ? 1 : 0);

/**
 * A row a robot, by its last session: verdict, figures, joints out of family, parameters that drift, whether it needs a
 * workshop. Those that need a look first, then the largest error of the calibrated URDF.
 */
export function robotRows({sessions = [], fleet = {}}) {
  const byRobot = new Map();
  for (const session of sessions) {
    if (!byRobot.has(session.robot)) byRobot.set(session.robot, []);
    byRobot.get(session.robot).push(session);
  }
  const of = (list, robot) => (list ?? []).filter((one) => one.robot === robot).map((one) => one.parameter);
  const rows = [...byRobot].map(([robot, all]) => {
    const last = inTime(all).at(-1);
    return {
      robot, batch: last.batch ?? '', sessions: all.length, last, verdict: verdictOf(last), day: last.day,
      uncalibrated: last.uncalibrated_mm, urdf: last.urdf_mm, compensated: last.compensated_mm, postures: last.postures,
      out: of(fleet.out_of_family, robot), drifts: of(fleet.drifts, robot), workshop: (fleet.workshop ?? []).includes(robot),
    };
  });
  return rows.sort((a, b) => urgency(b) - urgency(a) || (b.urdf ?? -1) - (a.urdf ?? -1));
}

/** The batches of the maker: how many robots, how many to be deployed, half of their URDFs err by less than. */
export function batchRows(robots) {
  const byBatch = new Map();
  for (const robot of robots) {
    if (!byBatch.has(robot.batch)) byBatch.set(robot.batch, []);
    byBatch.get(robot.batch).push(robot);
  }
  const median = (values) => values.length > 0 ? values.sort((a, b) => a - b)[Math.floor(values.length / 2)] : null;
  return [...byBatch].map(([batch, all]) => ({
    batch, robots: all.length, fine: all.filter((robot) => robot.verdict === 'fine').length,
    workshop: all.filter((robot) => robot.workshop).length,
    urdf: median(all.map((robot) => robot.urdf).filter((x) => typeof x === 'number')),
  })).sort((a, b) => a.batch < b.batch ? -1 : 1);
}

/** The fleet in one sentence, with the state that colours it. */
export function fleetVerdict(robots) {
  const number = (verdict) => robots.filter((robot) => robot.verdict === verdict).length;
  const [fine, refused, failed] = [number('fine'), number('refused'), number('failed')];
  const workshop = robots.filter((robot) => robot.workshop).length;
  const state = failed + refused > 0 ? 'reject' : workshop > 0 ? 'check' : 'deploy';
  return {state, fine, refused, failed, workshop};
}
