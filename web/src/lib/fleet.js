// SPDX-License-Identifier: Apache-2.0
// Statements on the robots of a fleet, from the sessions and findings of a batch.

const DEPLOYABLE = 0;  // exit codes of calibrate
const REFUSED = 4;

const VERDICTS = {fine: 'to be deployed', refused: 'not to be deployed', failed: 'failed'};
export const verdictText = (verdict) => VERDICTS[verdict];

const verdictOf = ({exit_code: code}) => code === DEPLOYABLE ? 'fine' : code === REFUSED ? 'refused' : 'failed';

/** Sessions in the order of time. Those without a day keep their order. */
const inTime = (sessions) => sessions.map((session, i) => ({session, i}))
  .sort((a, b) => ((a.session.day ?? -Infinity) - (b.session.day ?? -Infinity) || a.i - b.i)).map(({session}) => session);

/** How urgently a robot needs attention; the largest number comes first. */
const urgency = (robot) => (robot.verdict === 'failed' ? 4 : 0) + (robot.verdict === 'refused' ? 3 : 0) + (robot.workshop ? 2 : 0) + (robot.drifts.length > 0 ? 1 : 0);

/**
 * A row for each robot, by its last session: verdict, figures, joints out of family, drifting parameters, and whether it
 * needs a workshop. Robots that need attention come first, then those with the largest error of the calibrated URDF.
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

/** The maker's batches: number of robots, number to be deployed, and median error of their URDFs. */
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

/** The verdict on the fleet: the state that colours it, and numbers of robots. */
export function fleetVerdict(robots) {
  const number = (verdict) => robots.filter((robot) => robot.verdict === verdict).length;
  const [fine, refused, failed] = [number('fine'), number('refused'), number('failed')];
  const workshop = robots.filter((robot) => robot.workshop).length;
  const state = failed + refused > 0 ? 'reject' : workshop > 0 ? 'check' : 'deploy';
  return {state, fine, refused, failed, workshop};
}
