// Runs to look through: sliders over what was swept and over time, turning gears, the force on the gear, speed and torque.
(() => {
  "use strict";
  const { decode, element, prefixOf, readable, style, colour, seconds, quantity, soon, whenSeenAnew, penOf, withMargin, timesAcross, valuesUp } = gearidae;
  const { COAST, onLine, turned, drawNear, drawForce } = gearidae.mesh;
  const holder = document.getElementById("explorer"), source = document.getElementById("explorer-data");
  if (!holder || !source) return;
  const data = JSON.parse(source.textContent);
  const LEFT = 62, RIGHT = 10, TOP = 8, BOTTOM = 22;
  const WIDE = data.columns.length;
  let run = null, frame = 0;
  let places = data.dims.map(() => 0);

  function take(number) {
    run = data.runs[number];
    if (!run.numbers) {
      run.numbers = decode(run.frames);
      run.rows = run.numbers.length / WIDE;
      run.lines = run.curves.map(decode);
    }
    run.look = data.looks[data.verdicts[number]];
  }

  // The picture in view, or the last one of a run that ended before; null of a run that has none.
  function now() {
    if (!run.rows) return null;
    const start = WIDE * Math.min(frame, run.rows - 1), found = {};
    data.columns.forEach((name, k) => { found[name] = run.numbers[start + k]; });
    return found;
  }

  // A picture is one of so many samples, and the last sample need not be one.
  const timeOf = (number) => data.start + (data.end - data.start) * number * data.every / Math.max(1, data.samples - 1);
  const pictureAt = (share) => Math.round(Math.min(1, Math.max(0, share)) * (data.samples - 1) / data.every);

  // Pairs on the path of contact of a flank, by their places [m]: the coast flank mirrors the other, half a pitch later.
  function pairPlaces(gears, flank, travel) {
    const phase = flank === COAST ? 2 * gears.approach / gears.pitch + 0.5 - travel : travel, found = [];
    for (let place = gears.pitch * (phase - Math.floor(phase)); place <= gears.path; place += gears.pitch) found.push(place);
    return found;
  }

  function drawMesh(state, gears) {
    const flank = state.coast_gap < state.drive_gap ? COAST : 0;
    const motion = { travel: state.travel * gears.pitch, error: state.transmission_error, speed: state.gear_speed };
    const near = drawNear(mesh, gears, motion, flank);
    if (!near) return;
    const { pen, at } = near, push = flank === COAST ? -state.mesh_force : state.mesh_force; // positive pushes the teeth apart
    drawForce(near, gears, flank, gears.approach, push, data.largest);
    for (const place of pairPlaces(gears, flank, state.travel)) {
      pen.beginPath();
      pen.arc(...at(onLine(gears, flank, place)), 5, 0, 2 * Math.PI);
      pen.fillStyle = state.pairs_in_contact > 0 ? colour(push < 0 ? 1 : 0) : style("--ground");
      pen.strokeStyle = style("--ink");
      pen.lineWidth = 1.5;
      pen.fill();
      pen.stroke();
    }
  }

  // Path of a whole wheel about its centre, in modules; made once.
  function wholeOf(wheel) {
    if (wheel.whole) return wheel.whole;
    wheel.whole = new Path2D();
    wheel.reach = 0;
    for (let k = 0; k < wheel.teeth; k++) {
      const angle = -2 * Math.PI * k / wheel.teeth, c = Math.cos(angle), s = Math.sin(angle);
      for (let i = 0; i < wheel.tooth.length; i += 8) { // every fourth point: a tooth is a few pixels
        const a = wheel.tooth[i], b = wheel.tooth[i + 1];
        wheel.whole.lineTo(c * a - s * b, s * a + c * b);
        wheel.reach = Math.max(wheel.reach, Math.hypot(a, b));
      }
    }
    wheel.whole.closePath();
    return wheel.whole;
  }

  // Both gears as a whole, the pinion to the left; a dot stands on tooth 0.
  function drawWhole(state, gears) {
    const sheet = penOf(whole);
    if (!sheet) return;
    const { pen, width, height } = sheet, wheels = [gears.pinion, gears.gear];
    wheels.forEach(wholeOf);
    const long = wheels.reduce((sum, wheel) => sum + wheel.reach + Math.abs(wheel.centre), 1), tall = 2 * Math.max(...wheels.map((wheel) => wheel.reach)) + 1;
    const size = Math.min(width / long, height / tall);
    const pitchPoint = (width - size * long) / 2 + size * (gears.pinion.centre + gears.pinion.reach + 0.5);
    const angles = turned(gears, state.travel * gears.pitch, state.transmission_error, 0);
    wheels.forEach((wheel, k) => {
      pen.save();
      pen.translate(pitchPoint, height / 2);
      pen.scale(size, -size);
      pen.rotate(Math.PI / 2);
      pen.translate(0, wheel.centre);
      pen.rotate(wheel.turning * angles[k]);
      pen.fillStyle = style(k ? "--gear" : "--pinion");
      pen.strokeStyle = style("--ink");
      pen.lineWidth = 0.8 / size;
      pen.fill(wheel.whole);
      pen.stroke(wheel.whole);
      pen.fillStyle = style("--ink");
      pen.beginPath(); pen.arc(0, 0, 3 / size, 0, 2 * Math.PI); pen.fill();
      pen.beginPath(); pen.arc(0, -Math.sign(wheel.centre) * (wheel.reach - 4), Math.max(3 / size, 0.6), 0, 2 * Math.PI); pen.fill();
      pen.restore();
    });
  }

  function drawCurve(plot, k) {
    const sheet = penOf(plot.canvas);
    if (!sheet) return;
    const { pen, width, height } = sheet, box = { left: LEFT, right: RIGHT, top: TOP, bottom: BOTTOM, width, height };
    const range = withMargin(data.ranges[k]), span = data.end - data.start || 1;
    const scale = plot.unit === "rad s-1" ? { factor: 1, prefix: "" } : prefixOf(Math.max(...range.map(Math.abs)));
    plot.title.textContent = plot.label + " (" + readable(scale.prefix, plot.unit) + ")";
    const x = timesAcross(pen, box, [data.start, data.start + span]), y = valuesUp(pen, box, range, scale.factor, 28);
    const values = run.lines[k];
    pen.strokeStyle = colour(0);
    pen.lineWidth = 1.4;
    pen.beginPath();
    values.forEach((value, i) => { if (!Number.isNaN(value)) pen.lineTo(x(data.start + span * i / (values.length - 1 || 1)), y(value)); });
    pen.stroke();
    const here = x(timeOf(frame));
    pen.strokeStyle = style("--ink");
    pen.lineWidth = 1;
    pen.beginPath(); pen.moveTo(here, TOP); pen.lineTo(here, height - BOTTOM); pen.stroke();
  }

  function wordsOf(state) {
    const time = timeOf(frame), ended = run.rows - 1 < frame && run.rows < data.frames;
    const words = ["t = " + seconds(time)];
    if (!state) return words.concat("the run has no samples").join("  ·  ");
    if (ended) words.push("the run ended at " + seconds(timeOf(run.rows - 1)));
    words.push("gear " + state.gear_speed.toPrecision(4) + " rad/s", "torque of the contacts " + quantity(state.gear_contact_torque, "N m"),
      "force of all pairs " + quantity(state.mesh_force, "N"), "gap " + quantity(state.drive_gap, "m", 3) + " (drive), " + quantity(state.coast_gap, "m", 3) + " (coast)",
      state.pairs_in_contact + (state.pairs_in_contact === 1 ? " pair" : " pairs") + " in contact");
    return words.join("  ·  ");
  }

  function draw() {
    const state = now(), gears = data.gears[run.gears];
    for (const canvas of [mesh, whole]) canvas.hidden = !state;
    if (state) { drawMesh(state, gears); drawWhole(state, gears); }
    plots.forEach(drawCurve);
    slider.value = frame;
    slider.setAttribute("aria-valuetext", seconds(timeOf(frame)));
    readout.textContent = wordsOf(state);
  }

  const later = soon(draw);

  function show(index, tell) {
    frame = Math.max(0, Math.min(data.frames - 1, index));
    if (tell) document.dispatchEvent(new CustomEvent("gearidae:cursor", { detail: timeOf(frame) }));
    later();
  }

  // Another run at the same time.
  function choose(number) {
    places = gearidae.placesOf(data, number);
    take(number);
    sliders.forEach(({ input, output, dim }, k) => {
      input.value = places[k];
      output.textContent = dim.values[places[k]];
      input.setAttribute("aria-valuetext", output.textContent);
    });
    if (showMap) showMap(number, [number]);
    verdict.replaceChildren();
    gearidae.chip(verdict, run.look, data.words[number]);
    stage.style.borderColor = run.look.colour;
    later();
  }

  const board = element("div", holder, "", { className: "sliders" });
  const sliders = data.dims.map((dim, k) => {
    const label = element("label", board), name = element("span", label, dim.name), output = element("output", label);
    const input = element("input", label, "", { type: "range", min: 0, max: dim.values.length - 1, step: 1, value: 0 });
    input.addEventListener("input", () => {
      places[k] = Number(input.value);
      choose(gearidae.runAt(data, places));
    });
    name.className = "name";
    return { input, dim, output };
  });
  const showMap = data.dims.length ? gearidae.outcomeMap(holder, data, choose) : null;
  const verdict = element("p", holder, "", { className: "verdict" });
  verdict.setAttribute("aria-live", "polite");
  const everything = () => [0, data.frames - 1];
  const { slider, stop } = gearidae.player(holder, "time", () => frame, everything, (index) => show(index, true));
  slider.max = data.frames - 1;
  const readout = element("output", holder);
  const stage = element("div", holder, "", { className: "stage" });
  const [left, right] = ["left", "right"].map((name) => element("div", stage, "", { className: name }));
  const figureOf = (words, name, parent) => {
    const figure = element("figure", parent, "", { className: name }), canvas = element("canvas", figure);
    canvas.setAttribute("role", "img");
    canvas.setAttribute("aria-label", words);
    return canvas;
  };
  const mesh = figureOf("both gears near the pitch point", "near", left);
  element("figcaption", mesh.parentElement, "Teeth to scale, gaps between them × " + data.gaps + ". Arrow: force of all pairs on the gear; blue pushes, orange pulls.");
  const plots = [["Speed of the gear", "rad s-1"], ["Torque of the tooth contacts on the gear", "N m"]].map(([label, unit]) => {
    const canvas = figureOf(label + " over time", "curve", right), title = element("figcaption", canvas.parentElement);
    const pointed = (event) => {
      const box = canvas.getBoundingClientRect(), share = (event.clientX - box.left - LEFT) / (box.width - LEFT - RIGHT);
      stop();
      show(pictureAt(share), true);
    };
    canvas.addEventListener("pointerdown", (event) => { canvas.setPointerCapture(event.pointerId); pointed(event); });
    canvas.addEventListener("pointermove", (event) => { if (event.buttons) pointed(event); });
    return { canvas, title, label, unit };
  });
  const whole = figureOf("both gears as a whole", "whole", left);
  element("figcaption", whole.parentElement, "Whole gears; a dot marks one tooth of each.");
  const notes = ["The curves have the same axes for all runs."];
  if (data.every > 1) notes.unshift("One of every " + data.every + " samples is a picture; the curves hold the smallest and largest values between.");
  element("p", holder, notes.join(" "), { className: "hint" });

  document.addEventListener("gearidae:teeth", (event) => {
    stop();
    show(pictureAt((event.detail - data.start) / (data.end - data.start || 1)), false);
  });
  whenSeenAnew(draw, later);
  choose(0);
  draw();
})();
