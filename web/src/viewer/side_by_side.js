// SPDX-License-Identifier: Apache-2.0
import * as THREE from 'three';

import {OKABE_ITO} from '../lib/colours.js';
import {Robot} from './robot.js';
import {Stage} from './stage.js';

const LOOKED_AT = 8;  // number of pictures
const GAP = 0.25;     // m between robots
const UP = new THREE.Vector3(0, 1, 0);

/** A robot whose links are placed one by one, independently of its joints. */
class LooseRobot {
  constructor(urdf, meshes, links) {
    const robot = new Robot(urdf, meshes);
    this.object = new THREE.Group();
    this.links = links.map((name) => robot.links[name]);
    this.links.forEach((link) => {
      if (!link) return;
      link.matrixAutoUpdate = false;
      this.object.add(link);
    });
  }

  /** `poses`: a matrix for each link. */
  place(poses) {
    this.links.forEach((link, k) => link?.matrix.copy(poses[k]));
    this.object.updateMatrixWorld(true);
  }

  paint(change) {
    this.object.traverse((node) => node.isMesh && change(node.material));
    return this;
  }
}

/** Rods from hands and feet of the plan to those of the drawn robot. */
class Rods {
  constructor(count, colour) {
    this.object = new THREE.Group();
    const material = new THREE.MeshBasicMaterial({color: colour, depthTest: false, transparent: true});
    this.rods = Array.from({length: count}, () => {
      const rod = new THREE.Mesh(new THREE.CylinderGeometry(0.009, 0.009, 1, 8), material);
      rod.renderOrder = 2;
      this.object.add(rod);
      return rod;
    });
  }

  set(k, from, to) {
    const way = to.clone().sub(from);
    const length = way.length();
    const rod = this.rods[k];
    rod.visible = length > 1e-3;
    if (!rod.visible) return;
    rod.position.copy(from).addScaledVector(way, 0.5);
    rod.quaternion.setFromUnitVectors(UP, way.divideScalar(length));
    rod.scale.set(1, length, 1);
  }
}

/** The plan, and beside it each robot that executed it, drawn over a shadow of the plan. */
export class SideBySide {
  constructor(canvas, data, playback) {
    this.playback = playback;
    const {urdf, meshes} = data.robot;
    this.plan = new Robot(urdf, meshes);
    this.stage = new Stage(canvas);
    this.columns = playback.robots.map((robot) => this.column(robot, urdf, meshes));
    for (const object of [this.plan.object, ...this.columns.map((c) => c.object)]) this.stage.scene.add(object);
    this.factor = 10;
    this.frame();
  }

  column(robot, urdf, meshes) {
    const {links} = this.playback;
    const executed = new LooseRobot(urdf, meshes, links);
    const shadow = new LooseRobot(urdf, meshes, links).paint((material) => {
      material.transparent = true;
      material.opacity = 0.3;
      material.depthWrite = false;
      material.color.set(OKABE_ITO.sky);
    });
    const tips = robot.tips.map((tip) => links.indexOf(tip.link));
    const rods = new Rods(tips.length, OKABE_ITO.vermillion);
    const object = new THREE.Group();
    object.add(shadow.object, executed.object, rods.object);
    return {robot, executed, shadow, tips, rods, object};
  }

  setSize(width, height) {
    this.stage.resize(width, height);
    if (Math.abs(this.stage.camera.aspect - (this.framedAspect ?? 0)) > 0.2) this.frame();
  }

  /** Places the robots side by side, seen from the front, with room for the whole motion. */
  frame() {
    this.framedAspect = this.stage.camera.aspect;
    const {times} = this.playback;
    const box = new THREE.Box3();
    const count = Math.min(LOOKED_AT, times.length);
    for (let k = 0; k < count; ++k) {
      this.placePlan(Math.floor(k * times.length / count));
      box.union(this.plan.bounds());
    }
    const pitch = box.max.y - box.min.y + GAP;
    // Seen from the front, the plan is on the left.
    this.columns.forEach((column, k) => column.object.position.set(0, pitch * (k + 1), 0));
    this.names = [0, ...this.columns.map((c) => c.object.position.y)].map((y) => new THREE.Vector3((box.min.x + box.max.x) / 2, (box.min.y + box.max.y) / 2 + y, box.max.z + 0.08));
    box.max.y += pitch * this.columns.length;
    this.stage.frame(box, 0.62);
  }

  /** Places of the robots' names in the picture, as shares of its width and height. */
  heads() {
    return this.names.map((point) => {
      const {x, y, z} = point.clone().project(this.stage.camera);
      return {x: (1 + x) / 2, y: (1 - y) / 2, seen: z < 1};
    });
  }

  placePlan(i) {
    const {playback, plan} = this;
    const root = playback.root(i);
    plan.setPosture(playback.joints, playback.posture(i));
    plan.setRoot(root.position, root.quaternion);
    plan.object.updateMatrixWorld(true);
  }

  /** Draws picture i with displacements multiplied by `factor`. */
  show(i) {
    this.index = i;
    this.placePlan(i);
    const poses = this.playback.links.map((name) => this.plan.links[name]?.matrixWorld ?? new THREE.Matrix4());
    for (const column of this.columns) this.placeColumn(column, i, poses);
    this.stage.invalidate();
  }

  placeColumn({robot, executed, shadow, tips, rods}, i, poses) {
    const factor = robot.factor(i, this.factor);
    const moved = poses.map((pose, link) => displaced(pose, robot.displacement(i, link), factor));
    shadow.place(poses);
    executed.place(moved);
    const origin = (matrix) => new THREE.Vector3().setFromMatrixPosition(matrix);
    tips.forEach((link, k) => link >= 0 && rods.set(k, origin(poses[link]), origin(moved[link])));
  }
}

/** A pose after a displacement in the axes of the room, multiplied by `factor`. */
function displaced(pose, [x, y, z, ...turn], factor) {
  const vector = new THREE.Vector3(...turn).multiplyScalar(factor);
  const angle = vector.length();
  const place = new THREE.Vector3().setFromMatrixPosition(pose).add(new THREE.Vector3(x, y, z).multiplyScalar(factor));
  const result = new THREE.Matrix4();
  if (angle > 0) result.makeRotationAxis(vector.divideScalar(angle), angle);
  return result.multiply(new THREE.Matrix4().extractRotation(pose)).setPosition(place);
}
