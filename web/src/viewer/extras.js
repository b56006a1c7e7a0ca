// SPDX-License-Identifier: Apache-2.0
import * as THREE from 'three';

/** Adds collision spheres to their links. `spheres`: [{link, centre_m, radius_m}]. */
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

/** Adds the markers of the project: [{link, position_m}]. */
export function addMarkers(robot, markers, colour) {
  const material = new THREE.MeshLambertMaterial({color: colour});
  const size = Math.max(...robot.bounds().getSize(new THREE.Vector3()).toArray());
  const ball = new THREE.SphereGeometry(0.007 * size, 12, 8);
  return markers.flatMap((marker) => {
    const link = robot.links[marker.link];
    if (!link) return [];
    const mesh = new THREE.Mesh(ball, material);
    mesh.position.fromArray(marker.position_m);
    link.add(mesh);
    return [mesh];
  });
}

/** Adds the soles of feet: [{link, min_m, max_m}], rectangles in the plane z = 0 of the link. */
export function addSoles(robot, soles, colour) {
  const material = new THREE.MeshBasicMaterial({color: colour, side: THREE.DoubleSide, transparent: true, opacity: 0.6, depthTest: false});  // visible through the foot
  return soles.flatMap((sole) => {
    const link = robot.links[sole.link];
    if (!link) return [];
    const [length, width] = [0, 1].map((k) => sole.max_m[k] - sole.min_m[k]);
    const mesh = new THREE.Mesh(new THREE.PlaneGeometry(length, width), material);
    mesh.position.set(...[0, 1].map((k) => 0.5 * (sole.max_m[k] + sole.min_m[k])), 0);
    link.add(mesh);
    return [mesh];
  });
}

/** Adds workspaces as boxes in the frame of a link, by default the root: [{link, min_m, max_m}]. */
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
