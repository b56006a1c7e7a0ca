// SPDX-License-Identifier: Apache-2.0
import * as THREE from 'three';
import {OrbitControls} from 'three/examples/jsm/controls/OrbitControls.js';

const FLOOR = 0x7d858f;  // between light and dark, to be visible on both

/** Camera, light and floor. It draws only if something has changed. */
export class Stage {
  constructor(canvas) {
    this.canvas = canvas;
    this.renderer = new THREE.WebGLRenderer({canvas, antialias: true, alpha: true, preserveDrawingBuffer: true});
    this.scene = new THREE.Scene();
    this.camera = new THREE.PerspectiveCamera(32, 1, 0.05, 60);
    this.camera.up.set(0, 0, 1);
    this.addLights();
    this.controls = new OrbitControls(this.camera, canvas);
    this.controls.enablePan = false;
    this.controls.enableZoom = false;  // until the picture has the focus, so that the page can scroll
    canvas.style.touchAction = 'pan-y';
    this.controls.addEventListener('change', () => this.invalidate());
    canvas.addEventListener('focus', () => { this.controls.enableZoom = true; });
    canvas.addEventListener('blur', () => { this.controls.enableZoom = false; });
    canvas.addEventListener('pointerdown', () => canvas.focus({preventScroll: true}));
    canvas.addEventListener('keydown', (event) => this.onKey(event));
  }

  addLights() {
    this.scene.add(new THREE.HemisphereLight(0xffffff, 0xa4a6ac, 2.7));
    const sun = new THREE.DirectionalLight(0xffffff, 1.5);
    sun.position.set(2, -3, 5);
    this.scene.add(sun);
  }

  /** Points the camera at a box from the front, a little to the side, and puts the floor under the box. */
  frame(box, yaw) {
    const centre = box.getCenter(new THREE.Vector3());
    const size = box.getSize(new THREE.Vector3());
    const slope = Math.tan(THREE.MathUtils.degToRad(this.camera.fov / 2));
    const across = Math.hypot(size.x, size.y);
    const distance = 1.06 * Math.max(size.z, 0.8 * across / this.camera.aspect) / (2 * slope) + 0.35 * across;
    const angle = yaw - 0.62;
    this.controls.target.copy(centre);
    this.camera.position.set(Math.cos(angle), Math.sin(angle), 0.24).normalize().multiplyScalar(distance).add(centre);
    this.home = {position: this.camera.position.clone(), target: centre.clone()};
    this.controls.update();
    this.addFloor(centre, box.min.z, Math.max(4, Math.ceil(across + 2)));
  }

  addFloor(centre, height, size) {
    this.floor?.removeFromParent();
    this.floor = new THREE.GridHelper(size, 4 * size, FLOOR, FLOOR);
    this.floor.rotation.x = Math.PI / 2;
    this.floor.position.set(centre.x, centre.y, height);
    this.floor.material.transparent = true;
    this.floor.material.opacity = 0.32;
    this.scene.add(this.floor);
  }

  /** Arrow keys turn the view, plus and minus zoom, 0 resets it. */
  onKey(event) {
    const offset = this.camera.position.clone().sub(this.controls.target);
    const turn = {ArrowLeft: -0.12, ArrowRight: 0.12}[event.key];
    const tilt = {ArrowUp: 0.1, ArrowDown: -0.1}[event.key];
    const zoom = {'+': 0.9, '=': 0.9, '-': 1.1}[event.key];
    if (turn !== undefined) {
      offset.applyAxisAngle(this.camera.up, turn);
    } else if (tilt !== undefined) {
      const flat = Math.hypot(offset.x, offset.y);
      const elevation = Math.min(1.5, Math.max(-1.5, Math.atan2(offset.z, flat) + tilt));
      const length = offset.length();
      offset.set(offset.x / flat * Math.cos(elevation), offset.y / flat * Math.cos(elevation), Math.sin(elevation)).multiplyScalar(length);
    } else if (zoom !== undefined) {
      offset.multiplyScalar(zoom);
    } else if (event.key === '0' && this.home) {
      offset.copy(this.home.position).sub(this.home.target);
    } else {
      return;
    }
    event.preventDefault();
    this.camera.position.copy(this.controls.target).add(offset);
    this.controls.update();
    this.invalidate();
  }

  /** Sets the size, and draws again only if something was drawn, because drawing costs most here. */
  resize(width, height) {
    if (width < 1 || height < 1 || (width === this.width && height === this.height)) return;
    [this.width, this.height] = [width, height];
    this.renderer.setPixelRatio(Math.min(2, devicePixelRatio));
    this.renderer.setSize(width, height, false);
    this.camera.aspect = width / height;
    this.camera.updateProjectionMatrix();
    if (this.drawn) this.draw();
  }

  invalidate() {
    if (this.pending) return;
    this.pending = requestAnimationFrame(() => this.draw());
  }

  draw() {
    cancelAnimationFrame(this.pending);
    this.pending = 0;
    this.drawn = true;
    this.renderer.render(this.scene, this.camera);
    this.afterDraw?.();
  }
}
