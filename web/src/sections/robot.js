// SPDX-License-Identifier: Apache-2.0
import {css, sequential} from '../lib/colours.js';
import {h} from '../lib/dom.js';
import {choice, section} from '../lib/figure.js';
import {fixed, modelName} from '../lib/format.js';
import {setPlaying} from '../lib/play.js';
import {range} from '../lib/range.js';
import {advance} from '../viewer/clips.js';
import {Viewer} from '../viewer/viewer.js';

function toggle(text, checked, change) {
  return h('label', {class: 'check'}, h('input', {type: 'checkbox', checked, onchange: (e) => change(e.target.checked)}), text);
}

function colourBar(end) {
  const stops = [0, 0.25, 0.5, 0.75, 1].map((t) => css(sequential(t))).join(', ');
  return h('p', {class: 'colour-bar'}, h('span', {}, '0'),
           h('span', {class: 'bar', style: {background: `linear-gradient(90deg, ${stops})`}, 'aria-hidden': 'true'}),
           h('span', {}, `${end} mm: RMSE of the cluster to which a ball belongs`));
}

/** The controls below the picture and their effects. */
class Panel {
  constructor(viewer) {
    this.viewer = viewer;
    this.position = 0;
    this.status = h('p', {class: 'viewer-status', 'aria-live': 'off'});
    this.play = h('button', {type: 'button', class: 'play', 'aria-pressed': 'false', onclick: () => this.setPlaying(!this.playing)}, 'Play');
    this.posture = range('Posture', {min: 0, max: 0, step: 1, value: 0, id: 'posture'}, (i) => { this.setPlaying(false); this.go(i); });
    this.magnification = range('Residuals magnified', {min: 1, max: 100, step: 1, value: viewer.magnification, id: 'magnification'},
      (x) => { viewer.magnification = x; this.go(viewer.index); });
    this.element = h('div', {class: 'viewer-panel'}, this.status,
      h('div', {class: 'transport'}, this.play, this.posture.row), h('div', {class: 'options'}, this.options()));
  }

  options() {
    const {viewer} = this;
    const {data} = viewer;
    const models = viewer.shown;
    const residuals = {before: models.slice(0, 1), after: models.slice(-1), both: models};
    const show = (meshes, visible) => { for (const mesh of meshes) mesh.visible = visible; viewer.stage.invalidate(); };
    show([...viewer.spheres, ...viewer.workspaces], false);
    return [
      viewer.clips.length > 1 && this.clipChooser(),
      models.length > 1 && choice('Residuals', [{value: 'before', text: 'Before'}, {value: 'after', text: 'After'}, {value: 'both', text: 'Both'}], 'both',
        (which) => { viewer.shown = residuals[which]; this.go(viewer.index); }),
      models.length > 0 && this.magnification.row,
      (data.clusters ?? []).length > 0 && toggle('Colour by cluster', true, (on) => { viewer.byCluster = on; this.go(viewer.index); }),
      viewer.drafted.length > 0 && toggle('Markers', true, (on) => show(viewer.drafted, on)),
      viewer.spheres.length > 0 && toggle('Collision spheres', false, (on) => show(viewer.spheres, on)),
      viewer.workspaces.length > 0 && toggle('Workspaces', false, (on) => show(viewer.workspaces, on)),
    ];
  }

  clipChooser() {
    const groups = new Map();
    this.viewer.clips.forEach((clip, i) => {
      if (!groups.has(clip.group)) groups.set(clip.group, []);
      groups.get(clip.group).push(h('option', {value: i}, clip.name || 'recording'));
    });
    return h('label', {class: 'select'}, h('span', {}, 'Recording'), h('select', {id: 'clip', onchange: (e) => this.choose(Number(e.target.value))},
      ...[...groups].map(([label, options]) => h('optgroup', {label: label[0].toUpperCase() + label.slice(1)}, ...options))));
  }

  choose(index) {
    const select = this.element.querySelector('#clip');
    if (select) select.value = String(index);
    this.viewer.setClip(index);
    this.posture.slider.max = this.viewer.clip.count - 1;
    this.go(0);
  }

  go(i) {
    const {viewer} = this;
    viewer.show(i);
    this.posture.slider.value = i;
    const {clip} = viewer;
    if (!clip) return;
    this.posture.output.textContent = `${i + 1} / ${clip.count}`;
    this.magnification.output.textContent = `× ${viewer.magnification}`;
    const [first, last] = [viewer.data.models?.[0], viewer.data.models?.at(-1)];
    const [before, after] = [viewer.rmse(i, first), viewer.rmse(i, last)];
    const time = clip.moving && clip.time.length > 0 ? ` · ${fixed(clip.time[i], 1)} s` : '';
    const errors = Number.isFinite(after) ? ` · RMSE ${fixed(before)} mm ${modelName(first)}, ${fixed(after)} mm ${modelName(last)}` : '';
    this.status.textContent = `${clip.name || clip.group}${time}${errors}`;
  }

  setPlaying(playing) {
    if (!this.playing) this.position = this.viewer.index;
    setPlaying(this, playing);
  }

  tick(now) {
    if (!this.playing) return;
    const seconds = this.last === undefined ? 0 : Math.min(0.25, (now - this.last) / 1000);
    this.last = now;
    this.position = advance(this.viewer.clip, this.position, seconds);
    const i = Math.floor(this.position);
    if (i !== this.viewer.index) this.go(i);
    requestAnimationFrame((t) => this.tick(t));
  }
}

function cannotDraw(error) {
  return h('p', {class: 'notice'}, `The robot cannot be drawn here: ${error.message}. All figures below are complete without it.`);
}

function wordsOf(report, measured) {
  if (measured) return 'The balls are the measured markers. From each ball a rod leads to where the nominal robot (orange) and the calibrated robot (blue) predict the marker; the rods are longer than the residuals by the factor of magnification. A foot that stands on the floor is green.';
  if ((report.motions ?? []).length > 0) return 'The view shows the planned motion. A foot that stands on the floor is green; the orange disc is the zero-moment point.';
  return 'The view shows the posture of rest with what the project file says: markers (orange balls), soles (green), and, switched on below, the spheres that stand for the body and the workspaces of hands and feet. Where one is wrong, correct it in the project file and make this page again.';
}

/** The robot with measured and predicted markers, or the robot of the project. */
export function robotSection(report) {
  if (!report.data?.robot?.urdf) return null;
  const canvas = h('canvas', {tabindex: '0', role: 'img', 'aria-label': 'The robot in 3-D. Arrow keys turn the view, plus and minus bring it nearer, 0 takes it back.'});
  const frame = h('div', {class: 'viewer'}, canvas);
  const clusters = (report.data.clusters ?? []).length > 0;
  const measured = (report.data.markers ?? []).length > 0;
  const result = section('robot', 'Robot', measured ? 'The robot and its residuals' : 'The robot',
    wordsOf(report, measured), frame);
  // Wait until the page has its width.
  queueMicrotask(() => {
    try {
      const viewer = new Viewer(canvas, report);
      const panel = new Panel(viewer);
      frame.after(clusters ? colourBar(viewer.scaleEnd) : '', panel.element);
      viewer.setSize(frame.clientWidth, frame.clientHeight);
      if (viewer.clips.length > 0) panel.choose(viewer.firstClip()); else viewer.show(0);
      panel.play.disabled = !(viewer.clip?.count > 1);
      viewer.stage.draw();
      new ResizeObserver(() => viewer.setSize(frame.clientWidth, frame.clientHeight)).observe(frame);
      frame.dataset.ready = String(Math.round(performance.now()));
    } catch (error) {
      frame.replaceChildren(cannotDraw(error));
    }
  });
  return result;
}
