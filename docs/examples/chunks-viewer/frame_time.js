/// Milliseconds that a part of a frame takes, smoothed over about ten frames.
export class FrameTime {
  milliseconds = 0;

  add(milliseconds) {
    this.milliseconds += (milliseconds - this.milliseconds) / 10;
  }

  of(work) {
    const start = performance.now();
    work();
    this.add(performance.now() - start);
  }
}
