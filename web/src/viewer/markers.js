import * as THREE from 'three';

const UP = new THREE.Vector3(0, 1, 0);
const HIDDEN = new THREE.Matrix4().makeScale(0, 0, 0);

function instances(geometry, count) {
  const mesh = new THREE.InstancedMesh(geometry, new THREE.MeshLambertMaterial(), count);
  mesh.frustumCulled = false;
  mesh.count = count;
  for (let i = 0; i < count; ++i) mesh.setColorAt(i, new THREE.Color(0xffffff));
  return mesh;
}

/**
 * Measured markers as balls, predicted ones as small balls at the end of a rod from the measured
 * one, which is as long as the residual times `magnification`.
 */
export class MarkerCloud {
  constructor(count) {
    this.count = count;
    this.measured = instances(new THREE.SphereGeometry(0.013, 16, 12), count);
    this.predicted = instances(new THREE.SphereGeometry(0.009, 12, 8), count);
    this.rods = instances(new THREE.CylinderGeometry(0.0045, 0.0045, 1, 8), count);
    this.object = new THREE.Group();
    this.object.add(this.measured, this.predicted, this.rods);
  }

  /** `measured`, `predicted`: x, y, z of each marker, m; NaN where it was not seen. */
  set(measured, predicted, magnification) {
    const from = new THREE.Vector3();
    const to = new THREE.Vector3();
    const matrix = new THREE.Matrix4();
    const turn = new THREE.Quaternion();
    for (let m = 0; m < this.count; ++m) {
      from.fromArray(measured, 3 * m);
      to.fromArray(predicted, 3 * m);
      const seen = Number.isFinite(from.x);
      const known = seen && Number.isFinite(to.x);
      this.measured.setMatrixAt(m, seen ? matrix.makeTranslation(from) : HIDDEN);
      to.sub(from).multiplyScalar(magnification);
      const length = to.length();
      turn.setFromUnitVectors(UP, length > 0 ? to.clone().divideScalar(length) : UP);
      const middle = from.clone().addScaledVector(to, 0.5);
      this.rods.setMatrixAt(m, known ? matrix.compose(middle, turn, new THREE.Vector3(1, length, 1)) : HIDDEN);
      this.predicted.setMatrixAt(m, known ? matrix.makeTranslation(from.add(to)) : HIDDEN);
    }
    for (const mesh of this.object.children) mesh.instanceMatrix.needsUpdate = true;
  }

  /** `colours`: CSS colour of each measured marker; `residual`: of rods and predicted ones. */
  paint(colours, residual) {
    const colour = new THREE.Color();
    const tip = new THREE.Color(residual);
    for (let m = 0; m < this.count; ++m) {
      this.measured.setColorAt(m, colour.set(colours[m]));
      this.predicted.setColorAt(m, tip);
      this.rods.setColorAt(m, tip);
    }
    for (const mesh of this.object.children) mesh.instanceColor.needsUpdate = true;
  }
}
