// The timeline's canvas: curves of the person and of what was shown, contacts, trim, flaws, now.

const LANES = [["roll", "Lean"], ["pitch", "Bend"], ["yaw", "Twist"], ["height", "Height"], ["right", "Right arm"], ["left", "Left arm"], ["step", "Steps"]];
const FEET = ["FR", "FL", "RR", "RL"];
const LEFT = 74, TOP = 20, FOOT = 6, GRIP = 9;

export class Timeline {
  constructor(canvas, on) {
    this.canvas = canvas;
    this.on = on;
    this.t = 0;
    this.speed = 0;
    this.stamp = performance.now();
    canvas.addEventListener("pointerdown", (e) => this.down(e));
    canvas.addEventListener("pointermove", (e) => this.move(e));
    canvas.addEventListener("pointerup", (e) => this.up(e));
    canvas.addEventListener("pointercancel", (e) => this.up(e));
    new ResizeObserver(() => this.draw()).observe(canvas);
    const each = () => { if (this.data && this.speed && canvas.offsetParent) this.draw(); requestAnimationFrame(each); };
    requestAnimationFrame(each);
  }

  load(data, info, flaws) {
    this.data = data;
    this.version = (this.version ?? 0) + 1;
    this.seconds = data.seconds;
    this.trim = info.trim ?? [0, data.seconds];
    this.cuts = info.cuts ?? [];
    this.flaws = flaws;
    this.draw();
  }

  at(t, speed) {
    if (this.held === "seek" || (t === this.t && speed === this.speed)) return;
    this.t = t;
    this.speed = speed;
    this.stamp = performance.now();
    this.draw();
  }

  get now() { return Math.min(this.seconds, this.t + (this.speed * (performance.now() - this.stamp)) / 1000); }
  x(t) { return LEFT + (t / this.seconds) * (this.width - LEFT - 12); }
  time(x) { return Math.max(0, Math.min(this.seconds, ((x - LEFT) / (this.width - LEFT - 12)) * this.seconds)); }

  down(event) {
    if (!this.data) return;
    const { x, y } = this.where(event);
    const near = this.trim.map((t) => Math.abs(this.x(t) - x));
    const grip = near[0] < near[1] ? 0 : 1;
    this.held = near[grip] < GRIP && (y < TOP + 16 || near[grip] < 5) ? grip : "seek";
    this.canvas.setPointerCapture(event.pointerId);
    this.move(event);
  }

  move(event) {
    if (!this.data) return;
    const { x } = this.where(event);
    if (this.held === undefined) {
      this.canvas.style.cursor = this.trim.some((t) => Math.abs(this.x(t) - x) < GRIP) ? "ew-resize" : "pointer";
      return;
    }
    const t = this.time(x);
    if (this.held === "seek") {
      this.t = t;
      this.speed = 0;
      // The last position must arrive; those on the way may be thinned.
      clearTimeout(this.late);
      const wait = 60 - (performance.now() - (this.sent ?? 0));
      const send = () => { this.sent = performance.now(); this.on.seek(t); };
      if (wait <= 0) send(); else this.late = setTimeout(send, wait);
    } else {
      const other = this.trim[1 - this.held];
      this.trim[this.held] = this.held === 0 ? Math.min(t, other - 0.1) : Math.max(t, other + 0.1);
      this.moved = true;
    }
    this.draw();
  }

  up(event) {
    if (this.held === undefined) return;
    if (this.held !== "seek" && this.moved) this.on.trim(this.trim.map((t) => Math.round(1000 * t) / 1000));
    this.held = this.moved = undefined;
  }

  where(event) {
    const box = this.canvas.getBoundingClientRect();
    return { x: event.clientX - box.left, y: event.clientY - box.top };
  }

  // Curves are painted once; afterwards only what lies over them moves.
  draw() {
    const { canvas } = this, ratio = devicePixelRatio || 1;
    const width = canvas.clientWidth, height = canvas.clientHeight;
    if (!width || !this.data) return;
    const style = getComputedStyle(document.documentElement);
    const color = (name) => style.getPropertyValue(`--${name}`).trim();
    const key = [width, height, ratio, document.documentElement.dataset.theme, this.version].join();
    if (key !== this.key) {
      this.key = key;
      this.width = width;
      canvas.width = Math.round(width * ratio);
      canvas.height = Math.round(height * ratio);
      this.curves = document.createElement("canvas");
      this.curves.width = canvas.width;
      this.curves.height = canvas.height;
      const below = this.curves.getContext("2d");
      below.setTransform(ratio, 0, 0, ratio, 0, 0);
      this.paint(below, color, width, height);
    }
    const g = canvas.getContext("2d");
    g.setTransform(1, 0, 0, 1, 0, 0);
    g.clearRect(0, 0, canvas.width, canvas.height);
    g.drawImage(this.curves, 0, 0);
    g.setTransform(ratio, 0, 0, ratio, 0, 0);
    this.marks(g, color, height);
  }

  paint(g, color, width, height) {
    const { data } = this;
    g.font = "11px system-ui, sans-serif";
    this.ruler(g, color, height);
    const bottom = height - 4 * FOOT - 8, lane = (bottom - TOP) / LANES.length;
    LANES.forEach(([name, title], i) => {
      const middle = TOP + (i + 0.5) * lane, k = data.channels.indexOf(name);
      g.fillStyle = color("muted");
      g.fillText(title, 10, middle + 4);
      g.strokeStyle = color("line");
      this.path(g, [[LEFT, middle], [width - 12, middle]], 1);
      if (k < 0) return;
      const sides = { robot: data.robot.map((row) => row[k] ?? 0), human: data.human.map((row) => row[k] ?? 0) };
      const most = [...sides.robot, ...sides.human].reduce((high, v) => Math.max(high, Math.abs(v)), 1);
      for (const [side, paint] of [["robot", "reference"], ["human", "human"]]) {
        g.strokeStyle = color(paint);
        this.path(g, data.t.map((t, j) => [this.x(t), middle - (0.46 * lane * sides[side][j]) / most]), 1.6);
      }
    });
    g.fillStyle = color("good");
    FEET.forEach((_, i) => {
      const y = bottom + 4 + i * FOOT;
      let from = null;
      data.t.forEach((t, j) => {
        const down = data.contact[j][i] >= 0.5, last = j === data.t.length - 1;
        if (down && from === null) from = t;
        if (from !== null && (!down || last)) { g.fillRect(this.x(from), y, Math.max(1, this.x(t) - this.x(from)), FOOT - 2); from = null; }
      });
    });
    g.fillStyle = color("muted");
    g.fillText("Paws down", 10, bottom + 4 + 2 * FOOT + 3);
  }

  ruler(g, color, height) {
    const rough = this.seconds / Math.max(2, (this.width - LEFT) / 90);
    const gap = [0.1, 0.2, 0.5, 1, 2, 5, 10, 30, 60, 300, 600].find((s) => s >= rough) ?? 1200;
    g.fillStyle = color("muted");
    for (let t = 0; t <= this.seconds + 1e-6; t += gap) {
      g.fillText(`${+t.toFixed(1)} s`, this.x(t) + 3, 12);
      g.strokeStyle = color("line");
      this.path(g, [[this.x(t), 4], [this.x(t), height]], 0.6);
    }
  }

  marks(g, color, height) {
    g.globalAlpha = 0.3;
    g.fillStyle = color("warn");
    for (const flaw of this.flaws) g.fillRect(this.x(flaw.start), TOP, Math.max(3, this.x(flaw.end) - this.x(flaw.start)), height - TOP);
    g.fillStyle = color("bad");
    for (const [a, b] of this.cuts) g.fillRect(this.x(a), TOP, this.x(b) - this.x(a), height - TOP);
    g.globalAlpha = 0.62;
    g.fillStyle = color("bg-2");
    const [start, end] = this.trim.map((t) => this.x(t));
    g.fillRect(LEFT, 0, start - LEFT, height);
    g.fillRect(end, 0, this.width - end, height);
    g.globalAlpha = 1;
    for (const [x, out] of [[start, -1], [end, 1]]) {
      g.fillStyle = color("accent");
      g.fillRect(x - 1, 0, 2, height);
      g.beginPath();
      g.roundRect(x - (out < 0 ? 9 : 0), 0, 9, 18, 3);
      g.fill();
    }
    const now = this.x(this.now);
    g.fillStyle = color("text");
    g.fillRect(now - 0.75, 0, 1.5, height);
    g.beginPath();
    g.arc(now, TOP - 4, 4.5, 0, 7);
    g.fill();
  }

  path(g, points, thick) {
    g.lineWidth = thick;
    g.beginPath();
    points.forEach(([x, y], i) => (i ? g.lineTo(x, y) : g.moveTo(x, y)));
    g.stroke();
  }
}
