// Two gears in mesh, to scale: outlines, points of the lines of action, arrows of forces. Lengths in modules, the pitch point is the origin.
(() => {
  "use strict";
  const { style, colour, penOf } = gearidae;
  const COAST = 1;
  const ACROSS = 4.6, DOWN = 1.9, UP = 2.0, TEETH = 5, LONGEST = 1.4; // modules; teeth on either side

  // Point of a flank's line of action by its place along the path of contact [m].
  function onLine(gears, flank, place) {
    const beyond = (place - gears.approach) / gears.module;
    return [(flank === COAST ? -1 : 1) * beyond * Math.cos(gears.angle), -beyond * Math.sin(gears.angle)];
  }

  // Angles that the teeth at the pitch point have turned beyond it, by the travel of the gear and the transmission error [m].
  // Where the backlash is drawn smaller than the gaps are, the gap of the flank in use is true.
  function turned(gears, travel, error, flank) {
    const beyond = travel - gears.approach, play = flank === COAST ? 2 * gears.halfBacklash - gears.play : 0;
    return [(beyond - gears.halfBacklash + play + gears.gaps * error) / gears.pinion.base, beyond / gears.gear.base];
  }

  // Path of the teeth nearest to the mesh, so many on either side, closed by the rim.
  function outline(pen, wheel, turned, x, y, teeth) {
    const pitch = 2 * Math.PI / wheel.teeth, count = Math.min(teeth, Math.floor((wheel.teeth - 1) / 2));
    const passed = Math.round(turned / pitch), beyond = turned - passed * pitch;
    const error = (k) => wheel.errors[((passed + wheel.turning * k) % wheel.teeth + wheel.teeth) % wheel.teeth] || 0; // those that follow lag behind
    pen.beginPath();
    let first = null, last = null;
    for (let k = -count; k <= count; k++) {
      const angle = wheel.turning * beyond - k * pitch - error(k), c = Math.cos(angle), s = Math.sin(angle);
      for (let i = 0; i < wheel.tooth.length; i += 2) {
        const a = c * wheel.tooth[i] - s * wheel.tooth[i + 1], b = s * wheel.tooth[i] + c * wheel.tooth[i + 1];
        first = first || [a, b];
        last = [a, b];
        pen.lineTo(x(a), y(b + wheel.centre));
      }
    }
    const from = Math.atan2(last[1], last[0]), sweep = (Math.atan2(first[1], first[0]) - from + 4 * Math.PI) % (2 * Math.PI);
    for (let k = 0; k <= 40; k++) {
      const angle = from + sweep * k / 40;
      pen.lineTo(x(wheel.rim * Math.cos(angle)), y(wheel.rim * Math.sin(angle) + wheel.centre));
    }
    pen.closePath();
  }

  // Both gears near the pitch point and the lines of action, of which the one that is not in use is dashed. Gives the pen, and the place
  // of a point in pixels; null while the canvas is not shown.
  function drawNear(canvas, gears, { travel, error, speed }, used) {
    const sheet = penOf(canvas);
    if (!sheet) return null;
    const { pen, width, height } = sheet, size = Math.min(width / (2 * ACROSS), height / (UP + DOWN));
    const x = (a) => width / 2 + size * a, y = (b) => height / 2 + size * ((UP - DOWN) / 2 - b);
    const angles = turned(gears, travel, error, used);
    [gears.pinion, gears.gear].forEach((wheel, k) => {
      outline(pen, wheel, angles[k], x, y, TEETH);
      pen.fillStyle = style(k ? "--gear" : "--pinion");
      pen.strokeStyle = style("--ink");
      pen.lineWidth = 1;
      pen.fill();
      pen.stroke();
    });
    for (const flank of [0, COAST]) {
      pen.setLineDash(flank === used ? [] : [5, 4]);
      pen.strokeStyle = style(flank === used ? "--ink" : "--faint");
      pen.beginPath();
      for (const place of [0, gears.path]) {
        const [a, b] = onLine(gears, flank, place);
        pen.lineTo(x(a), y(b));
      }
      pen.stroke();
    }
    pen.setLineDash([]);
    pen.fillStyle = style("--ink");
    pen.font = "13px system-ui, sans-serif";
    pen.textBaseline = "middle";
    pen.textAlign = "left";
    const way = speed < 0 ? " ←" : " →";
    pen.fillText("pinion, drives" + way, 8, 14);
    pen.fillText("gear" + way, 8, height - 14);
    return { pen, at: ([a, b]) => [x(a), y(b)] };
  }

  // A force at a place of a line of action, positive where it pushes: long enough to be seen beside a mark, none for a hundredth of the largest.
  function drawForce({ pen, at }, gears, flank, place, force, largest) {
    if (!(Math.abs(force) > 0.01 * largest)) return;
    const [a, b] = at(onLine(gears, flank, place)), [c, d] = at(onLine(gears, flank, place + gears.module));
    const share = Math.max(Math.abs(force) / largest, 0.2) * Math.sign(force) * LONGEST;
    arrow(pen, [a, b], [(c - a) * share, (d - b) * share], colour(force > 0 ? 0 : 1));
  }

  // From a point along a vector, in pixels.
  function arrow(pen, [a, b], along, ink) {
    const length = Math.hypot(...along), head = Math.min(12, length);
    const unit = [along[0] / length, along[1] / length], tip = [a + along[0], b + along[1]];
    const foot = [tip[0] - head * unit[0], tip[1] - head * unit[1]];
    pen.strokeStyle = pen.fillStyle = ink;
    pen.lineWidth = 3;
    pen.beginPath(); pen.moveTo(a, b); pen.lineTo(...foot); pen.stroke();
    pen.beginPath();
    pen.moveTo(...tip);
    pen.lineTo(foot[0] - unit[1] * head / 2, foot[1] + unit[0] * head / 2);
    pen.lineTo(foot[0] + unit[1] * head / 2, foot[1] - unit[0] * head / 2);
    pen.fill();
  }

  // Path of a whole wheel about its centre, of one of so many points of its teeth, clockwise unless it says another step; made once.
  function wholeOf(wheel, every = 4) { // every fourth point: a tooth is a few pixels
    const known = wheel.whole || (wheel.whole = {});
    if (known[every]) return known[every];
    const path = known[every] = new Path2D(), step = wheel.step || -2 * Math.PI / wheel.teeth;
    wheel.reach = 0;
    for (let k = 0; k < wheel.teeth; k++) {
      const angle = step * k, c = Math.cos(angle), s = Math.sin(angle);
      for (let i = 0; i < wheel.tooth.length; i += 2 * every) {
        const a = wheel.tooth[i], b = wheel.tooth[i + 1];
        path.lineTo(c * a - s * b, s * a + c * b);
        wheel.reach = Math.max(wheel.reach, Math.hypot(a, b));
      }
    }
    path.closePath();
    return path;
  }

  gearidae.mesh = { COAST, onLine, turned, drawNear, drawForce, arrow, wholeOf };
})();
