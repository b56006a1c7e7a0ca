// SPDX-License-Identifier: Apache-2.0
import * as THREE from 'three';

import {css, MODEL_COLOURS, OKABE_ITO, sequential} from '../lib/colours.js';
import {addMarkers, addSoles, addSpheres, addWorkspaces, makeZmp} from './extras.js';
import {makeClips} from './clips.js';
import {MarkerCloud} from './markers.js';
import {Robot} from './robot.js';
import {Stage} from './stage.js';

const LOOKED_AT = 8;  // frames

/**
 * The robot with its measurements. Throws if the browser has no WebGL or the URDF cannot be drawn.
 * Methods set the state, and `show(i)` draws.
 */
export class Viewer {
  constructor(canvas, report) {
    this.report = report;
    this.data = report.data ?? {};
    this.robot = new Robot(this.data.robot.urdf, this.data.robot.meshes);
    this.stage = new Stage(canvas);
    this.stage.scene.add(this.robot.object);
    this.markers = new MarkerCloud((this.data.markers ?? []).length);
    this.stage.scene.add(this.markers.object);
    this.spheres = addSpheres(this.robot, this.data.spheres ?? [], OKABE_ITO.sky);
    this.workspaces = addWorkspaces(this.robot, this.data.workspaces ?? [], OKABE_ITO.purple);
    this.drafted = addMarkers(this.robot, this.data.project?.markers ?? [], OKABE_ITO.orange);
    this.soles = addSoles(this.robot, this.data.project?.soles ?? [], OKABE_ITO.green);
    this.zmp = makeZmp(OKABE_ITO.vermillion);
    this.stage.scene.add(this.zmp);
    this.clips = makeClips(report, this.robot);
    const models = this.data.models ?? [];
    this.shown = models.length > 1 ? [models[0], models.at(-1)] : models;  // their residuals are shown
    this.magnification = 20;
    this.byCluster = true;
    this.framed = null;
  }

  setSize(width, height) {
    this.stage.resize(width, height);
  }

  setClip(index) {
    this.clip = this.clips[index];
    this.robot.placeFeet(this.clip.joints, this.clip.standing);
    this.framed = null;
    this.show(0);
  }

  /** The first clip to show: postures in which most markers are seen. */
  firstClip() {
    const seen = (clip) => clip.moving ? 0 : clip.markers;
    return this.clips.reduce((best, clip, i) => seen(clip) > seen(this.clips[best]) ? i : best, 0);
  }

  /** RMSE, mm, for the brightest colour: the largest of any cluster and model, rounded up. */
  get scaleEnd() {
    const worst = Math.max(0, ...(this.data.clusters ?? []).flatMap((c) => Object.values(c.rmse_3d_mm ?? {})));
    return worst > 0 ? Math.ceil(worst) : 1;
  }

  paint() {
    const clusters = new Map((this.data.clusters ?? []).map((c) => [c.name, c.rmse_3d_mm?.[this.shown[0]]]));
    const end = this.scaleEnd;
    const colours = (this.data.markers ?? []).map((marker) => {
      const rmse = clusters.get(marker.cluster);
      return this.byCluster && typeof rmse === 'number' ? css(sequential(rmse / end)).replaceAll(' ', ',') : OKABE_ITO.orange;
    });
    this.markers.paint(colours);
  }

  /** Places the robot and everything on it for frame i of the clip. */
  show(i) {
    if (this.framed !== this.clip || !this.clip) this.frameClip();
    const frame = this.clip?.at(i);
    this.index = i;
    if (frame) this.place(frame);
    this.stage.invalidate();
  }

  /** Points the camera so that the whole clip, judged by a few frames, is in view. */
  frameClip() {
    this.framed = this.clip;
    const frames = Math.min(LOOKED_AT, this.clip?.count ?? 0);
    const box = new THREE.Box3();
    for (let k = 0; k < frames; ++k) {
      this.place(this.clip.at(Math.floor(k * this.clip.count / frames)));
      box.union(this.robot.bounds());
    }
    const forward = new THREE.Vector3(1, 0, 0).applyQuaternion(this.robot.object.quaternion);
    this.stage.frame(box.isEmpty() ? this.robot.bounds() : box, Math.atan2(forward.y, forward.x));
  }

  place(frame) {
    this.robot.setPosture(this.clip.joints, frame.q);
    if (frame.root && frame.root.position.every(Number.isFinite)) {
      this.robot.setRoot(frame.root.position, frame.root.quaternion);
    } else if (!frame.root) {
      this.robot.standOn(frame.support[0]);
    }
    this.robot.object.updateMatrixWorld(true);
    this.robot.tint(frame.support, OKABE_ITO.green);
    this.markers.object.visible = Boolean(frame.measured);
    if (frame.measured) {
      this.markers.setMeasured(frame.measured);
      for (const model of this.shown) {
        const predicted = frame.predicted(model) ?? new Float32Array(frame.measured.length).fill(NaN);
        const rods = this.markers.rodsOf(model, MODEL_COLOURS[model] ?? OKABE_ITO.blue);
        this.markers.setPredicted(rods, frame.measured, predicted, this.magnification);
      }
      this.markers.only(this.shown);
      this.paint();
    }
    this.zmp.visible = Boolean(frame.zmp);
    if (frame.zmp) this.zmp.position.set(frame.zmp[0], frame.zmp[1], 0.003);
  }

  /** RMSE of the markers in frame i with a model, mm; NaN without markers. */
  rmse(i, model) {
    const frame = this.clip?.at(i);
    const predicted = frame?.predicted?.(model);
    if (!predicted) return NaN;
    let sum = 0;
    let count = 0;
    for (let k = 0; k < predicted.length; k += 3) {
      const square = (predicted[k] - frame.measured[k]) ** 2 + (predicted[k + 1] - frame.measured[k + 1]) ** 2 + (predicted[k + 2] - frame.measured[k + 2]) ** 2;
      if (!Number.isFinite(square)) continue;
      sum += square;
      ++count;
    }
    return count ? 1e3 * Math.sqrt(sum / count) : NaN;
  }
}
