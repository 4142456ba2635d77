// The clock: play, pause, speed, repeat; the time in frames.

const SPEEDS = [0.01, 0.02, 0.05, 0.1, 0.2, 0.5, 1, 2, 5, 10];
/** Approximate duration of a whole run at the first speed [s]. */
const LASTS = 6;

class Clock {
  constructor(count, step, moved) {
    Object.assign(this, { count, step, moved, index: 0, isPlaying: false, repeats: true, frameTimes: [] });
    const wanted = (step * (count - 1)) / LASTS;
    this.speed = SPEEDS.reduce((best, s) => (Math.abs(Math.log(s / wanted)) < Math.abs(Math.log(best / wanted)) ? s : best));
  }

  get last() {
    return this.count - 1;
  }

  get time() {
    return this.index * this.step;
  }

  seek(index) {
    this.index = Math.min(Math.max(index, 0), this.last);
    this.moved();
  }

  play(on) {
    if (on === this.isPlaying) return;
    this.isPlaying = on;
    if (on) {
      if (this.index >= this.last) this.index = 0;
      this.before = undefined;
      this.frameTimes = [];
      requestAnimationFrame((now) => this.tick(now));
    }
    this.moved();
  }

  tick(now) {
    if (!this.isPlaying) return;
    // After a pause of the browser the motion continues where it was.
    const passed = this.before === undefined ? 0 : Math.min(now - this.before, 100);
    this.before = now;
    let index = this.index + (passed / 1000 / this.step) * this.speed;
    if (index > this.last) {
      if (this.repeats) index %= this.last || 1;
      else [index, this.isPlaying] = [this.last, false];
    }
    this.index = index;
    const began = performance.now();
    this.moved();
    this.frameTimes.push([passed, performance.now() - began]);
    if (this.frameTimes.length > 600) this.frameTimes.shift();
    requestAnimationFrame((next) => this.tick(next));
  }
}
