import * as THREE from "three";

const kSteps = { KeyW: [0, 0, -1], KeyS: [0, 0, 1], KeyA: [-1, 0, 0], KeyD: [1, 0, 0],
                 KeyQ: [0, -1, 0], KeyE: [0, 1, 0] };

/// Drag to look, keys to fly. The z axis points up.
export class FlyCamera {
  constructor(camera, canvas, speed) {
    this.camera = camera;
    this.speed = speed; // world units a second
    this.keys = new Set();
    camera.up.set(0, 0, 1);
    addEventListener("keydown", (event) => this.keys.add(event.code));
    addEventListener("keyup", (event) => this.keys.delete(event.code));
    addEventListener("blur", () => this.keys.clear());
    canvas.addEventListener("pointerdown", (event) => canvas.setPointerCapture(event.pointerId));
    canvas.addEventListener("pointermove", (event) => {
      if (event.buttons & 1) this.turn(event.movementX / 400, event.movementY / 400);
    });
  }

  turn(right, down) {
    const ahead = this.camera.getWorldDirection(new THREE.Vector3());
    const angle = Math.atan2(ahead.y, ahead.x) - right;
    const pitch = Math.max(-1.5, Math.min(1.5, Math.asin(ahead.z) - down));
    this.camera.lookAt(
      this.camera.position.x + Math.cos(angle) * Math.cos(pitch),
      this.camera.position.y + Math.sin(angle) * Math.cos(pitch),
      this.camera.position.z + Math.sin(pitch),
    );
  }

  move(seconds) {
    const fast = this.keys.has("ShiftLeft") || this.keys.has("ShiftRight") ? 5 : 1;
    for (const key of this.keys) {
      if (!(key in kSteps)) continue;
      const step = new THREE.Vector3(...kSteps[key]).multiplyScalar(this.speed * fast * seconds);
      this.camera.position.add(step.applyQuaternion(this.camera.quaternion));
    }
  }
}
