// SPDX-License-Identifier: Apache-2.0
import * as THREE from 'three';

const UP = new THREE.Vector3(0, 1, 0);
const HIDDEN = new THREE.Matrix4().makeScale(0, 0, 0);

function instances(geometry, count, colour = 0xffffff) {
  const mesh = new THREE.InstancedMesh(geometry, new THREE.MeshLambertMaterial(), count);
  mesh.frustumCulled = false;
  mesh.count = count;
  for (let i = 0; i < count; ++i) mesh.setColorAt(i, new THREE.Color(colour));
  return mesh;
}

/**
 * Shows measured markers as balls. A rod leads from each of them to a small ball, the predicted marker.
 * The length of the rod is the residual times `magnification`.
 */
export class MarkerCloud {
  constructor(count) {
    this.count = count;
    this.measured = instances(new THREE.SphereGeometry(0.013, 16, 12), count);
    this.object = new THREE.Group();
    this.object.add(this.measured);
    this.residuals = new Map();
  }

  /** The rods of a model. They are made at their first use. */
  rodsOf(model, colour) {
    if (!this.residuals.has(model)) {
      const tips = instances(new THREE.SphereGeometry(0.009, 12, 8), this.count, colour);
      const rods = instances(new THREE.CylinderGeometry(0.0045, 0.0045, 1, 8), this.count, colour);
      this.object.add(tips, rods);
      this.residuals.set(model, {tips, rods});
    }
    return this.residuals.get(model);
  }

  /** Hides the rods of all models but these. */
  only(models) {
    for (const [model, {tips, rods}] of this.residuals) tips.visible = rods.visible = models.includes(model);
  }

  /** Sets the measured positions: x, y, z of each marker, m; NaN if it was not seen. */
  setMeasured(measured) {
    const matrix = new THREE.Matrix4();
    for (let m = 0; m < this.count; ++m) {
      const seen = Number.isFinite(measured[3 * m]);
      this.measured.setMatrixAt(m, seen ? matrix.makeTranslation(...measured.subarray(3 * m, 3 * m + 3)) : HIDDEN);
    }
    this.measured.instanceMatrix.needsUpdate = true;
  }

  /** Sets the rods from the measured to the predicted positions. */
  setPredicted({tips, rods}, measured, predicted, magnification) {
    const from = new THREE.Vector3();
    const to = new THREE.Vector3();
    const matrix = new THREE.Matrix4();
    const turn = new THREE.Quaternion();
    for (let m = 0; m < this.count; ++m) {
      from.fromArray(measured, 3 * m);
      to.fromArray(predicted, 3 * m);
      const seen = Number.isFinite(from.x);
      const known = seen && Number.isFinite(to.x);
      to.sub(from).multiplyScalar(magnification);
      const length = to.length();
      turn.setFromUnitVectors(UP, length > 0 ? to.clone().divideScalar(length) : UP);
      const middle = from.clone().addScaledVector(to, 0.5);
      rods.setMatrixAt(m, known ? matrix.compose(middle, turn, new THREE.Vector3(1, length, 1)) : HIDDEN);
      tips.setMatrixAt(m, known ? matrix.makeTranslation(from.add(to)) : HIDDEN);
    }
    for (const mesh of [tips, rods]) mesh.instanceMatrix.needsUpdate = true;
  }

  /** `colours`: CSS colour of each measured marker. */
  paint(colours) {
    const colour = new THREE.Color();
    for (let m = 0; m < this.count; ++m) this.measured.setColorAt(m, colour.set(colours[m]));
    this.measured.instanceColor.needsUpdate = true;
  }
}
