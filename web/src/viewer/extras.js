// SPDX-License-Identifier: Apache-2.0
import * as THREE from 'three';

/** Collision spheres, carried by their links. `spheres`: [{link, centre_m, radius_m}]. */
export function addSpheres(robot, spheres, colour) {
  const material = new THREE.MeshLambertMaterial({color: colour, transparent: true, opacity: 0.28, depthWrite: false});
  return spheres.flatMap((sphere) => {
    const link = robot.links[sphere.link];
    if (!link) return [];
    const mesh = new THREE.Mesh(new THREE.SphereGeometry(sphere.radius_m, 24, 16), material);
    mesh.position.fromArray(sphere.centre_m);
    link.add(mesh);
    return [mesh];
  });
}

/** Workspaces as boxes in the frame of a link, the root's by default: [{link, min_m, max_m}]. */
export function addWorkspaces(robot, workspaces, colour) {
  return workspaces.map((workspace) => {
    const min = new THREE.Vector3().fromArray(workspace.min_m);
    const max = new THREE.Vector3().fromArray(workspace.max_m);
    const size = max.clone().sub(min);
    const edges = new THREE.EdgesGeometry(new THREE.BoxGeometry(...size.toArray()));
    const box = new THREE.LineSegments(edges, new THREE.LineBasicMaterial({color: colour}));
    box.position.copy(min).add(max).multiplyScalar(0.5);
    (robot.links[workspace.link] ?? robot.object).add(box);
    return box;
  });
}

/** A disc on the floor for the zero-moment point. */
export function makeZmp(colour) {
  const disc = new THREE.Mesh(new THREE.CylinderGeometry(0.022, 0.022, 0.006, 24),
                              new THREE.MeshLambertMaterial({color: colour, emissive: colour, emissiveIntensity: 0.5}));
  disc.rotation.x = Math.PI / 2;
  disc.visible = false;
  return disc;
}
