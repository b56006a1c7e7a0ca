// SPDX-License-Identifier: Apache-2.0
import {toCsv} from '../lib/csv.js';
import {h} from '../lib/dom.js';
import {choice, figure} from '../lib/figure.js';
import {fixed, list} from '../lib/format.js';
import {setPlaying} from '../lib/play.js';
import {distanceRows, pictureAt, playedRobots, readPlayback} from '../lib/playback.js';
import {range} from '../lib/range.js';
import {table} from '../lib/table.js';
import {SideBySide} from '../viewer/side_by_side.js';

const SPEEDS = [1, 5, 20];

/** The common clock of all robots, and the objects that draw them. */
class Player {
  constructor(view, names) {
    this.view = view;
    this.names = names;
    this.time = view.playback.times[0];
    this.speed = 5;
    const {times} = view.playback;
    this.play = h('button', {type: 'button', class: 'play', 'aria-pressed': 'false', onclick: () => this.setPlaying(!this.playing)}, 'Play');
    this.clock = range('Time', {min: times[0], max: times.at(-1), step: 0.1, value: times[0], id: 'playback-time'}, (t) => { this.setPlaying(false); this.go(t); });
    this.factor = range('Distance from the plan magnified', {min: 1, max: 50, step: 1, value: view.factor, id: 'playback-factor'}, (x) => { view.factor = x; this.go(this.time); });
    this.rows = view.columns.map(() => ({hand: h('span', {}), foot: h('span', {}), state: h('span', {})}));
    this.element = h('div', {class: 'viewer-panel'},
      h('div', {class: 'transport'}, this.play, this.clock.row,
        choice('Speed', SPEEDS.map((speed) => ({value: speed, text: `× ${speed}`})), this.speed, (speed) => { this.speed = speed; })),
      h('div', {class: 'options'}, this.factor.row), this.numbers());
  }

  numbers() {
    return table({caption: 'Distance from the plan now', className: 'playback-now',
      columns: [{text: 'The controller knows'}, {text: 'Hands', unit: 'mm', number: true}, {text: 'Swinging foot', unit: 'mm', number: true}, {text: 'Now'}],
      rows: this.view.columns.map(({robot}, k) => [this.names(robot), this.rows[k].hand, this.rows[k].foot, this.rows[k].state])});
  }

  go(time) {
    this.time = time;
    const {view} = this;
    const i = pictureAt(view.playback.times, time);
    if (i !== view.index || !this.playing) view.show(i);
    this.clock.slider.value = time;
    this.clock.output.textContent = `${fixed(time, 1)} s`;
    this.factor.output.textContent = `× ${view.factor}`;
    view.columns.forEach(({robot}, k) => this.say(robot, i, this.rows[k]));
  }

  say(robot, i, row) {
    row.hand.textContent = fixed(robot.distance(i, 'hand'), 1);
    row.foot.textContent = fixed(robot.distance(i, 'foot'), 1);
    const drawn = robot.factor(i, this.view.factor);
    const over = i >= robot.pictures && robot.pictures < this.view.playback.times.length;
    row.state.textContent = [over && `fell at ${fixed(this.view.playback.times[robot.pictures - 1], 0)} s`,
      drawn < this.view.factor && (drawn > 1.05 ? `drawn × ${fixed(drawn, drawn < 3 ? 1 : 0)}` : 'not magnified')].filter(Boolean).join(', ');
  }

  setPlaying(playing) {
    setPlaying(this, playing);
  }

  tick(now) {
    if (!this.playing) return;
    const seconds = this.last === undefined ? 0 : Math.min(0.25, (now - this.last) / 1000);
    this.last = now;
    const {times} = this.view.playback;
    const next = this.time + this.speed * seconds;
    this.go(next > times.at(-1) ? times[0] : next);
    requestAnimationFrame((t) => this.tick(t));
  }
}

/** Keeps the names above the robots in the view. */
function labels(view, frame, names) {
  const spans = view.heads().map((_, k) => h('span', {class: 'robot-name'}, k === 0 ? 'the plan' : names(view.columns[k - 1].robot)));
  frame.append(...spans);
  return () => view.heads().forEach(({x, y, seen}, k) => {
    spans[k].style.setProperty('left', `${100 * x}%`);
    spans[k].style.setProperty('top', `${100 * y}%`);
    spans[k].style.setProperty('visibility', seen ? 'visible' : 'hidden');
  });
}

/** Draws the robots into a frame and adds its panel. */
async function start(frame, panel, canvas, report, names) {
  try {
    const playback = await readPlayback(report.deployment.playback);
    const view = new SideBySide(canvas, report.data, playback);
    const player = new Player(view, names);
    panel.replaceWith(player.element);
    view.stage.afterDraw = labels(view, frame, names);
    view.setSize(frame.clientWidth, frame.clientHeight);
    player.go(playback.times[0]);
    view.stage.draw();
    new ResizeObserver(() => view.setSize(frame.clientWidth, frame.clientHeight)).observe(frame);
    frame.dataset.ready = String(Math.round(performance.now()));
  } catch (error) {
    frame.replaceChildren(h('p', {class: 'notice'}, `The robots cannot be drawn here: ${error.message}. The table has their distances from the plan.`));
  }
}

/** Calls `call` once when an element comes near the window, so that unseen figures cost nothing. */
function whenNear(element, call) {
  const observer = new IntersectionObserver((entries) => {
    if (!entries.some((entry) => entry.isIntersecting)) return;
    observer.disconnect();
    call();
  }, {rootMargin: '400px'});
  observer.observe(element);
}

/** The robots that executed the plan, beside it in 3-D; null if nothing was recorded. On paper, only the table is shown. */
export function playbackFigure(report, names) {
  const playback = report.deployment?.playback;
  const robots = playedRobots(playback);
  if (robots.length === 0 || !report.data?.robot?.urdf) return null;
  const canvas = h('canvas', {tabindex: '0', role: 'img', 'aria-label': `The plan and, beside it, the robots whose controllers know ${list(robots.map(names))}, in 3-D. Arrow keys turn the view, plus and minus bring it nearer, 0 takes it back.`});
  const frame = h('div', {class: 'viewer side-by-side'}, canvas);
  const panel = h('div', {class: 'viewer-panel'});
  const result = figure({title: 'The plan and the robots that execute it', body: [frame, panel],
    note: 'Blue is where the plan has the robot; red rods lead from the hands and feet of the plan to those of the robot. The robot is drawn further from the plan than it is, by the factor of magnification; one that is far off is magnified less. The numbers are not magnified: they are the largest distance of a hand, and of a foot in the air, seen from the foot that stands. All robots here have a stabiliser.',
    data: {name: 'deployment_in_time.csv', text: () => toCsv(['as', 'time_s', ...robots[0].tips.map((tip) => `${tip.link}_mm`)], distanceRows(playback))}});
  result.classList.add('playback', 'on-screen');
  whenNear(frame, () => start(frame, panel, canvas, report, names));
  return result;
}
