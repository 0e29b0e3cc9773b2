// Two gears in mesh, to scale: outlines, points of the lines of action, arrows of forces. Lengths in modules, the pitch point is the origin.
(() => {
  "use strict";
  const COAST = 1;

  // Point of a flank's line of action by its place along the path of contact [m].
  function onLine(gears, flank, place) {
    const beyond = (place - gears.approach) / gears.module;
    return [(flank === COAST ? -1 : 1) * beyond * Math.cos(gears.angle), -beyond * Math.sin(gears.angle)];
  }

  // Angles that the teeth at the pitch point have turned beyond it, by the travel of the gear and the transmission error [m].
  function turned(gears, travel, error) {
    const beyond = travel - gears.approach;
    return [(beyond - gears.halfBacklash + gears.gaps * error) / gears.pinion.base, beyond / gears.gear.base];
  }

  // Path of the teeth nearest to the mesh, so many on either side, closed by the rim.
  function outline(pen, wheel, turned, x, y, teeth) {
    const pitch = 2 * Math.PI / wheel.teeth, count = Math.min(teeth, Math.floor((wheel.teeth - 1) / 2));
    const beyond = turned - Math.round(turned / pitch) * pitch;
    pen.beginPath();
    let first = null, last = null;
    for (let k = -count; k <= count; k++) {
      const angle = wheel.turning * beyond - k * pitch, c = Math.cos(angle), s = Math.sin(angle);
      for (let i = 0; i < wheel.tooth.length; i += 2) {
        const a = c * wheel.tooth[i] - s * wheel.tooth[i + 1], b = s * wheel.tooth[i] + c * wheel.tooth[i + 1];
        first = first || [a, b];
        last = [a, b];
        pen.lineTo(x(a), y(b + wheel.centre));
      }
    }
    const size = wheel.rim / Math.hypot(...last);
    const from = Math.atan2(last[1], last[0]), sweep = (Math.atan2(first[1], first[0]) - from + 4 * Math.PI) % (2 * Math.PI);
    for (let k = 0; k <= 40; k++) {
      const angle = from + sweep * k / 40, radius = size * Math.hypot(...last);
      pen.lineTo(x(radius * Math.cos(angle)), y(radius * Math.sin(angle) + wheel.centre));
    }
    pen.closePath();
  }

  // Both gears near the pitch point and the lines of action; the one that is not in use is dashed.
  function drawPair(pen, gears, angles, x, y, teeth, used) {
    const { style } = gearidae;
    [gears.pinion, gears.gear].forEach((wheel, k) => {
      outline(pen, wheel, angles[k], x, y, teeth);
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

  gearidae.mesh = { COAST, onLine, turned, drawPair, arrow };
})();
