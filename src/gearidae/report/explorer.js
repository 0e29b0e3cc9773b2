// Runs to look through: sliders over what was swept and over time, curves, and the gears that pair.js or train.js draws.
(() => {
  "use strict";
  const { decode, element, prefixOf, readable, style, colour, seconds, soon, whenSeenAnew, penOf, withMargin, timesAcross, valuesUp } = gearidae;
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
    const start = WIDE * Math.min(frame, run.rows - 1);
    return view.stateOf(run.numbers.subarray(start, start + WIDE));
  }

  // A picture is one of so many samples, and the last sample need not be one.
  const timeOf = (number) => data.start + (data.end - data.start) * number * data.every / Math.max(1, data.samples - 1);
  const pictureAt = (share) => Math.round(Math.min(1, Math.max(0, share)) * (data.samples - 1) / data.every);

  function drawCurve(plot, k) {
    const sheet = penOf(plot.canvas);
    if (!sheet) return;
    const { pen, width, height } = sheet, box = { left: LEFT, right: RIGHT, top: TOP, bottom: BOTTOM, width, height };
    const range = withMargin(data.ranges[k]), span = data.end - data.start || 1;
    const scale = plot.unit === "rad s-1" ? { factor: 1, prefix: "" } : prefixOf(Math.max(...range.map(Math.abs)));
    plot.title.textContent = plot.label + " (" + readable(scale.prefix, plot.unit) + ")";
    const x = timesAcross(pen, box, [data.start, data.start + span]), y = valuesUp(pen, box, range, scale.factor, 28);
    pen.lineWidth = plot.names.length > 1 ? 1 : 1.4;
    plot.names.forEach((_, line) => {
      const values = run.lines[plot.first + line];
      pen.strokeStyle = colour(line);
      pen.beginPath();
      values.forEach((value, i) => { if (!Number.isNaN(value)) pen.lineTo(x(data.start + span * i / (values.length - 1 || 1)), y(value)); });
      pen.stroke();
    });
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
    return words.concat(view.wordsOf(state)).join("  ·  ");
  }

  function draw() {
    const state = now();
    view.draw(state, data.gears[run.gears]);
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
  const view = gearidae.explored(data, (words, name) => figureOf(words, name, left), left, () => later());
  let lines = 0;
  const plots = view.plots.map(({ label, unit, names }) => {
    const canvas = figureOf(label + " over time", "curve", right), caption = element("figcaption", canvas.parentElement), title = element("span", caption);
    const first = lines;
    lines += names.length;
    if (names.length > 1) names.forEach((name, k) => gearidae.keyOf(caption, name, k));
    const pointed = (event) => {
      const box = canvas.getBoundingClientRect(), share = (event.clientX - box.left - LEFT) / (box.width - LEFT - RIGHT);
      stop();
      show(pictureAt(share), true);
    };
    canvas.addEventListener("pointerdown", (event) => { canvas.setPointerCapture(event.pointerId); pointed(event); });
    canvas.addEventListener("pointermove", (event) => { if (event.buttons) pointed(event); });
    return { canvas, title, label, unit, names, first };
  });
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
