// SPDX-License-Identifier: Apache-2.0
import * as THREE from 'three';
import {STLLoader} from 'three/examples/jsm/loaders/STLLoader.js';
import URDFLoader from 'urdf-loader';

const BONE = 0x8a8f98;

/** Loads the given meshes by their file names in the URDF. Other meshes are left out. */
function meshLoader(meshes) {
  return (path, manager, material, done) => {
    const base64 = meshes[path] ?? meshes[path.replace(/^\.?\//, '')];
    if (base64 === undefined) return done(new THREE.Group());
    const bytes = Uint8Array.from(atob(base64), (c) => c.charCodeAt(0));
    return done(new THREE.Mesh(new STLLoader().parse(bytes.buffer), material));
  };
}

function bone(length, direction) {
  const rod = new THREE.Mesh(new THREE.CylinderGeometry(0.012, 0.012, length, 10),
                             new THREE.MeshLambertMaterial({color: BONE}));
  rod.quaternion.setFromUnitVectors(new THREE.Vector3(0, 1, 0), direction.clone().normalize());
  return rod;
}

/** Adds a rod to each joint of a link, so that a robot without shapes is visible. */
function addBones(link) {
  for (const joint of link.children.filter((child) => child.isURDFJoint)) {
    const length = joint.position.length();
    if (length < 1e-3) continue;
    const rod = bone(length, joint.position);
    rod.position.copy(joint.position).multiplyScalar(0.5);
    link.add(rod);
  }
}

/** Adds a rod along each sliding joint of a link, as long as the joint's position: {joint, rod}. */
function addSlides(link) {
  return link.children.filter((child) => child.jointType === 'prismatic').map((joint) => {
    const rod = bone(1, joint.axis);
    rod.visible = false;
    joint.add(rod);
    return {joint, rod};
  });
}

const meshesOf = (object) => {
  const meshes = [];
  const visit = (node) => {
    if (node.isMesh) meshes.push(node);
    for (const child of node.children) if (!child.isURDFJoint) visit(child);
  };
  visit(object);
  return meshes;
};

/**
 * The robot of a URDF, with boxes, cylinders, spheres and the given meshes (`meshes`: STL as base64 by
 * file name). z is up in its root link. Units are metres and radians.
 */
export class Robot {
  constructor(urdf, meshes = {}) {
    const loader = new URDFLoader();
    loader.parseCollision = false;
    loader.packages = (name) => `package://${name}`;  // as in the URDF
    loader.loadMeshCb = meshLoader(meshes);
    this.object = loader.parse(urdf);
    this.links = this.object.links;
    const drawn = Object.values(this.links).filter((link) => meshesOf(link).length > 0).length;
    this.slides = [];
    for (const link of Object.values(this.links)) {
      if (meshesOf(link).length === 0 && drawn * 2 < Object.keys(this.links).length) {
        addBones(link);
        this.slides.push(...addSlides(link));
      }
      for (const mesh of meshesOf(link)) {
        const color = mesh.material.color?.clone() ?? new THREE.Color(BONE);
        mesh.material = new THREE.MeshLambertMaterial({color});
      }
    }
  }

  /** Sets joints by name. Names that the robot does not have are ignored. */
  setPosture(names, values) {
    names.forEach((name, i) => {
      const joint = this.object.joints[name];
      if (joint && Number.isFinite(values[i])) joint.setJointValue(values[i]);
    });
    for (const {joint, rod} of this.slides) {
      const [value] = joint.jointValue;
      rod.visible = Math.abs(value) > 1e-3;
      rod.scale.y = Math.max(Math.abs(value), 1e-3);
      rod.position.copy(joint.axis).normalize().multiplyScalar(-0.5 * value);
    }
  }

  /** Sets the pose of the root link: position and quaternion x, y, z, w. */
  setRoot(position, quaternion) {
    this.object.position.set(...position);
    this.object.quaternion.set(...quaternion);
    this.object.updateMatrixWorld(true);
  }

  /**
   * Sets where the feet of a motion stand, from a frame in which all of them do: with the distances of
   * that frame, around their middle in the zero posture.
   */
  placeFeet(joints, standing) {
    this.zero = new Map();
    const feet = (standing?.support ?? []).filter((name) => this.links[name]);
    if (feet.length < 2) return;
    this.setPosture(joints, standing.q);
    this.standOn(feet[0]);
    const places = feet.map((name) => this.links[name].matrixWorld.clone());
    const position = (pose) => new THREE.Vector3().setFromMatrixPosition(pose);
    const shift = new THREE.Vector3();
    feet.forEach((name, k) => shift.add(position(this.zeroPose(name))).sub(position(places[k])));
    shift.divideScalar(feet.length);
    const move = new THREE.Matrix4().makeTranslation(shift.x, shift.y, 0);
    feet.forEach((name, k) => this.zero.set(name, places[k].premultiply(move)));
  }

  /**
   * Places the robot so that a foot is where it stands (placeFeet), or else where it is in the zero
   * posture with the root link above the origin and the foot on the ground. Without a foot, the root
   * link is at the origin.
   */
  standOn(linkName) {
    this.setRoot([0, 0, 0], [0, 0, 0, 1]);
    const link = this.links[linkName];
    if (!link) return;
    const root = this.zeroPose(linkName).multiply(link.matrixWorld.clone().invert());
    const position = new THREE.Vector3();
    const quaternion = new THREE.Quaternion();
    root.decompose(position, quaternion, new THREE.Vector3());
    this.setRoot(position.toArray(), quaternion.toArray());
  }

  /** Pose of a foot on the ground if all joints are at zero. */
  zeroPose(linkName) {
    this.zero ??= new Map();
    if (!this.zero.has(linkName)) {
      const joints = Object.values(this.object.joints).filter((joint) => joint.jointType !== 'fixed');
      const positions = joints.map((joint) => [...joint.jointValue]);
      for (const joint of joints) joint.setJointValue(...joint.jointValue.map(() => 0));
      this.object.updateMatrixWorld(true);
      const pose = this.links[linkName].matrixWorld.clone();
      pose.elements[14] = 0;
      this.zero.set(linkName, pose);
      joints.forEach((joint, k) => joint.setJointValue(...positions[k]));
      this.object.updateMatrixWorld(true);
    }
    return this.zero.get(linkName).clone();
  }

  /** Colours the links on which the robot stands. */
  tint(linkNames, colour) {
    for (const mesh of this.tinted ?? []) mesh.material.color.copy(mesh.userData.own);
    this.tinted = linkNames.flatMap((name) => {
      let link = this.links[name];
      // A sole often has no shape. Then the shape of the link that carries it is coloured.
      while (link && meshesOf(link).length === 0) link = link.parent?.parent?.isURDFLink ? link.parent.parent : null;
      return link ? meshesOf(link) : [];
    });
    for (const mesh of this.tinted) {
      mesh.userData.own ??= mesh.material.color.clone();
      mesh.material.color.set(colour);
    }
  }

  bounds() {
    const box = new THREE.Box3();
    for (const link of Object.values(this.links)) {
      for (const mesh of meshesOf(link)) {
        mesh.geometry.computeBoundingBox();
        box.union(mesh.geometry.boundingBox.clone().applyMatrix4(mesh.matrixWorld));
      }
    }
    return box.isEmpty() ? box.setFromObject(this.object) : box;
  }
}
