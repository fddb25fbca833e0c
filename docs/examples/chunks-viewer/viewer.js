import * as THREE from "three";
import { ChunkMeshes } from "./chunk_meshes.js";
import { kColours } from "./colours.js";
import { FlyCamera } from "./fly_camera.js";
import { FrameTime } from "./frame_time.js";
import { boxOf, selectLods, transitionMask } from "./lods.js";
import { startEye } from "./start_view.js";

const kLoudBackground = "#ff00ff"; // a crack in the ground cannot hide
const kQuietBackground = "#8f9aa5"; // pale and dark wires are seen before it
const kStartDirection = new THREE.Vector3(0.4, -1, 0.8); // from what is seen to the eye

/// Draws all chunks of an index, each at a level of its own.
export class Viewer {
  constructor(index, url) {
    this.index = index;
    this.meshes = new ChunkMeshes(index, url);
    this.pixelError = 1;
    this.drawn = null; // levels on the screen
    this.options = { wireframe: false, strips: false, freeze: false, loud: true, masks: true };
    this.updateTime = new FrameTime();
    this.renderTime = new FrameTime();
    this.makeScene();
    this.makeCamera();
    this.objects = index.chunks.map(() => {
      const object = new THREE.Mesh(new THREE.BufferGeometry());
      object.visible = false;
      this.scene.add(object);
      return object;
    });
    addEventListener("resize", () => this.resize());
    this.resize();
  }

  makeScene() {
    this.renderer = new THREE.WebGLRenderer({ antialias: true });
    this.renderer.setPixelRatio(devicePixelRatio);
    document.body.prepend(this.renderer.domElement);
    this.scene = new THREE.Scene();
    this.scene.background = new THREE.Color(kLoudBackground);
    const sky = new THREE.HemisphereLight("#ffffff", "#50483c", 1.6);
    sky.position.set(0, 0, 1);
    this.scene.add(sky);
    const sun = new THREE.DirectionalLight("#fff4dc", 2.2);
    sun.position.set(-3, -2, 4);
    this.scene.add(sun);
    const material = (color) => new THREE.MeshLambertMaterial({ color });
    const strips = [material("#e6e2d6"), material("#262b30")];
    this.materials = kColours.map((colour) => [material(colour), ...strips]);
  }

  /// Positions are counted from the index's origin: all numbers that the graphics card sees are
  /// small. Only the eye is asked for in world space.
  get eye() {
    return this.camera.position.toArray().map((x, axis) => x + this.index.origin[axis]);
  }

  /// The corners of all chunks' boxes, counted from the origin.
  corners() {
    const { origin, chunks } = this.index;
    return chunks.map(boxOf).flatMap((box) =>
      [0, 1, 2, 3, 4, 5, 6, 7].map((corner) =>
        origin.map((x, axis) => ((corner >> axis) & 1 ? box.max : box.min)[axis] - x),
      ),
    );
  }

  makeCamera() {
    const box = new THREE.Box3().setFromPoints(
      this.corners().map((corner) => new THREE.Vector3(...corner)),
    );
    this.size = box.getSize(new THREE.Vector3()).length();
    this.camera = new THREE.PerspectiveCamera(45, 1, this.size / 20000, this.size * 4);
    this.fly = new FlyCamera(this.camera, this.renderer.domElement, this.size / 20);
  }

  /// All of it in sight, from above, beside or below the panel.
  seeAll(panel) {
    const { camera } = this;
    const corners = this.corners();
    camera.lookAt(camera.position.clone().sub(kStartDirection));
    camera.updateMatrix();
    const axes = [new THREE.Vector3(), new THREE.Vector3(), new THREE.Vector3()];
    camera.matrix.extractBasis(...axes);
    const tangent = Math.tan((camera.fov / 360) * Math.PI);
    const window = { width: innerWidth, height: innerHeight, panel };
    const eye = startEye(corners, axes.map((axis) => axis.toArray()), tangent, window);
    camera.position.set(...eye);
    camera.far = 4 * this.size + camera.position.distanceTo(new THREE.Vector3(...corners[0]));
    camera.updateProjectionMatrix();
  }

  resize() {
    this.renderer.setSize(innerWidth, innerHeight);
    this.camera.aspect = innerWidth / innerHeight;
    this.camera.updateProjectionMatrix();
  }

  wantedLods() {
    const verticalAngle = (this.camera.fov / 180) * Math.PI;
    const screenHeight = this.renderer.domElement.height;
    return selectLods(this.index, { eye: this.eye, verticalAngle, screenHeight }, this.pixelError);
  }

  /// Draws at new levels once all their meshes are here: what is on the screen always fits
  /// together.
  update() {
    this.updateTime.of(() => this.chooseLevels());
  }

  chooseLevels() {
    if (this.options.freeze && this.drawn) return;
    // To begin with, the coarsest level: little to load.
    const wanted = this.drawn
      ? this.wantedLods()
      : this.index.chunks.map(({ levels }) => levels.length - 1);
    this.meshes.forgetQueue();
    let missing = 0;
    wanted.forEach((level, chunk) => (missing += this.meshes.has(chunk, level) ? 0 : 1));
    this.missing = missing;
    const isNew = !this.drawn || wanted.some((level, chunk) => level !== this.drawn[chunk]);
    if (missing > 0 || !isNew) return;
    const isFirst = !this.drawn;
    this.show(wanted);
    if (isFirst) this.chooseLevels(); // what is wanted in truth is asked for at once
  }

  show(lods) {
    this.drawn = lods;
    this.objects.forEach((object, chunk) => {
      const mask = this.options.masks ? transitionMask(this.index, chunk, lods) : 0;
      const state = `${lods[chunk]}/${mask}`;
      const materials = this.materials[lods[chunk] % kColours.length];
      object.material = this.options.strips ? materials : materials[0];
      if (object.userData.state === state) return;
      object.userData.state = state;
      object.geometry.dispose();
      object.geometry = this.meshes.geometry(chunk, lods[chunk], mask);
      object.visible = object.geometry.index !== null;
    });
  }

  set(option, value) {
    this.options[option] = value;
    for (const material of this.materials.flat()) material.wireframe = this.options.wireframe;
    const loud = this.options.loud && !this.options.wireframe;
    this.scene.background.set(loud ? kLoudBackground : kQuietBackground);
    if (this.drawn) this.show(this.drawn);
  }

  render() {
    this.renderTime.of(() => this.renderer.render(this.scene, this.camera));
  }

  /// Whether what the camera asks for is on the screen.
  get settled() {
    return this.drawn !== null && this.missing === 0 && this.meshes.pending === 0;
  }

  look(eye, target) {
    const local = (p) => p.map((x, axis) => x - this.index.origin[axis]);
    this.camera.position.set(...local(eye));
    this.camera.lookAt(...local(target));
    this.camera.updateMatrixWorld();
  }

  figures(frameMilliseconds) {
    const { render } = this.renderer.info;
    const triangles = render.triangles + render.lines / 3; // wires are three lines a triangle
    const levels = this.index.tolerances_voxels.map(
      (_, level) => this.drawn?.filter((lod) => lod === level).length ?? 0,
    );
    const update = this.updateTime.milliseconds.toFixed(2);
    const draw = this.renderTime.milliseconds.toFixed(1);
    return (
      `${this.index.chunks.length.toLocaleString("en")} chunks, at level 0, 1, ...: ${levels.join(", ")}\n` +
      `${triangles.toLocaleString("en")} triangles in ${render.calls.toLocaleString("en")} draw calls\n` +
      `${frameMilliseconds.toFixed(1)} ms a frame, of it here ${update} for levels, ${draw} to draw\n` +
      (this.meshes.failure?.message ??
        (this.missing ? `${this.missing} meshes on their way` : "all meshes here"))
    );
  }
}
