// Time series of a report: panels over one common time axis. No library, no network.
(() => {
  "use strict";
  const { decode, element, prefixOf, readable, style, colour, seconds, soon, whenSeenAnew, penOf, withMargin, timesAcross, valuesUp } = gearidae;
  const holder = document.getElementById("viewer");
  const source = document.getElementById("data");
  if (!holder || !source) return;
  const data = JSON.parse(source.textContent);

  const DASHES = [[], [8, 3], [2, 2], [8, 3, 2, 3], [5, 2], [11, 3, 2, 3], []];
  const LEFT = 62, RIGHT = 10, TOP = 8, BOTTOM = 24;
  const shortest = data.end * 20 / Math.max(data.samples, 40);
  const view = { from: 0, to: data.end };
  const hidden = new Set();
  const panels = [];
  // Runs that are drawn, each in a place of its own, which has a colour and dashes; and since when, the first one longest.
  const drawn = Array.from({ length: data.most }, (_, place) => (place < data.chosen.length ? data.chosen[place] : null));
  const since = [...data.chosen];
  const places = () => [...drawn.keys()].filter((place) => drawn[place] !== null);
  const seen = () => places().filter((place) => !hidden.has(drawn[place]));
  let cursor = null, followed = null, boxing = false, near = data.chosen[0]; // near: the map shows its part

  const later = soon(drawAll);

  function drawAll() {
    for (const panel of panels) if (!panel.box.hidden) draw(panel);
    legend.querySelectorAll(".swatch").forEach((swatch) => { swatch.style.color = colour(Number(swatch.dataset.place)); });
    report();
  }

  // Smallest and largest of some values in view.
  function extremesOf(values) {
    const [first, last] = indices(values);
    let low = Infinity, high = -Infinity;
    for (let i = first; i <= last; i++) {
      if (values[i] < low) low = values[i];
      if (values[i] > high) high = values[i];
    }
    return [low, high];
  }

  // Of what is in view, so that the scale follows the zoom.
  function rangeOf(panel) {
    if (panel.chosen) return panel.chosen;
    const ends = seen().map((place) => extremesOf(panel.valuesOf(drawn[place])));
    const low = Math.min(...ends.map((one) => one[0])), high = Math.max(...ends.map((one) => one[1]));
    if (!(low <= high)) return null;
    return withMargin([low, high]);
  }

  // The liveliest run goes to the back, so that it does not hide the others.
  function byLiveliness(panel) {
    const spread = drawn.map((run) => {
      if (run === null) return 0;
      const [low, high] = extremesOf(panel.valuesOf(run));
      return high - low;
    });
    return seen().sort((a, b) => spread[b] - spread[a]);
  }

  function indices(values) {
    const step = data.end / (values.length - 1 || 1);
    return [Math.max(0, Math.floor(view.from / step)), Math.min(values.length - 1, Math.ceil(view.to / step))];
  }

  function draw(panel) {
    const sheet = penOf(panel.canvas);
    if (!sheet) return;
    const { pen, width, height } = sheet, box = { left: LEFT, right: RIGHT, top: TOP, bottom: BOTTOM, width, height };
    const inner = width - LEFT - RIGHT, tall = height - TOP - BOTTOM, x = timesAcross(pen, box, [view.from, view.to]);
    const range = panel.range = rangeOf(panel);
    if (!range) return;
    const scale = panel.unit ? prefixOf(Math.max(Math.abs(range[0]), Math.abs(range[1]))) : { factor: 1, prefix: "" };
    panel.title.textContent = panel.label + (panel.unit ? " (" + readable(scale.prefix, panel.unit) + ")" : "");
    const y = valuesUp(pen, box, range, scale.factor, 32);

    pen.save();
    pen.beginPath(); pen.rect(LEFT, TOP, inner, tall); pen.clip();
    for (const place of byLiveliness(panel)) trace(pen, panel.valuesOf(drawn[place]), place, x, y, inner);
    contacts(pen, x, TOP + tall);
    if (followed !== null && followed >= view.from && followed <= view.to) {
      pen.setLineDash([4, 3]); pen.lineWidth = 1; pen.strokeStyle = style("--ink");
      pen.beginPath(); pen.moveTo(x(followed), TOP); pen.lineTo(x(followed), TOP + tall); pen.stroke();
    }
    if (cursor !== null && cursor >= view.from && cursor <= view.to) {
      pen.setLineDash([]); pen.lineWidth = 1; pen.strokeStyle = style("--ink");
      pen.beginPath(); pen.moveTo(x(cursor), TOP); pen.lineTo(x(cursor), TOP + tall); pen.stroke();
    }
    pen.restore();
  }

  // Where there are more values than pixels, each column of pixels shows its extremes: no peak is lost.
  function trace(pen, values, place, x, y, inner) {
    const [first, last] = indices(values), step = data.end / (values.length - 1 || 1);
    const perColumn = (last - first + 1) / Math.max(inner, 1);
    pen.strokeStyle = colour(place);
    pen.lineWidth = 1.4;
    pen.setLineDash(perColumn > 2 ? [] : DASHES[place % 7]);
    pen.beginPath();
    let open = false;
    const point = (index) => {
      const value = values[index];
      if (Number.isNaN(value)) { open = false; return; }
      if (open) pen.lineTo(x(index * step), y(value)); else pen.moveTo(x(index * step), y(value));
      open = true;
    };
    if (perColumn <= 2) {
      for (let i = first; i <= last; i++) point(i);
    } else {
      const size = Math.max(2, Math.floor(perColumn));
      // Blocks begin at multiples of their size, so that the picture does not flicker while it moves.
      for (let block = first - first % size; block <= last; block += size) {
        let low = -1, high = -1;
        for (let i = block; i < Math.min(block + size, values.length); i++) {
          if (Number.isNaN(values[i])) continue;
          if (low < 0 || values[i] < values[low]) low = i;
          if (high < 0 || values[i] > values[high]) high = i;
        }
        if (low < 0) { open = false; continue; }
        point(Math.min(low, high));
        point(Math.max(low, high));
      }
    }
    pen.stroke();
  }

  // Contacts made are long marks at the foot, contacts broken short ones.
  function contacts(pen, x, foot) {
    pen.setLineDash([]);
    pen.lineWidth = 1;
    for (const place of seen()) {
      const run = data.runs[drawn[place]];
      pen.strokeStyle = colour(place);
      for (const [times, length] of [[run.onsets, 10], [run.separations, 5]]) {
        pen.beginPath();
        for (const time of times) {
          if (time < view.from || time > view.to) continue;
          pen.moveTo(x(time), foot); pen.lineTo(x(time), foot - length);
        }
        pen.stroke();
      }
    }
  }

  function report() {
    if (cursor === null) {
      readout.textContent = "Showing " + seconds(view.from) + " to " + seconds(view.to);
      return;
    }
    const parts = ["t = " + seconds(cursor)];
    for (const panel of panels) {
      if (panel.box.hidden) continue;
      for (const run of seen().map((place) => drawn[place])) {
        const values = panel.valuesOf(run), value = values[Math.round(cursor / data.end * (values.length - 1))];
        const scale = panel.unit ? prefixOf(Math.abs(value)) : { factor: 1, prefix: "" };
        const label = data.runs.length > 1 ? " [" + data.runs[run].label + "]" : "";
        const shown = Number.isNaN(value) ? "not reached" : (value * scale.factor).toPrecision(5);
        parts.push(panel.name.replaceAll("_", " ") + label + " " + shown + " " + readable(scale.prefix, panel.unit));
      }
    }
    readout.textContent = parts.join("  ·  ");
  }

  function look(from, to) {
    const span = Math.min(data.end, Math.max(shortest, to - from));
    const start = Math.min(Math.max(0, from + (to - from - span) / 2), data.end - span);
    view.from = start;
    view.to = start + span;
    document.dispatchEvent(new CustomEvent("gearidae:view", { detail: { from: view.from, to: view.to } }));
    later();
  }
  function zoom(factor, about) {
    const centre = about === undefined ? (view.from + view.to) / 2 : about;
    const span = Math.min(data.end, Math.max(shortest, (view.to - view.from) * factor));
    const start = centre - (centre - view.from) / (view.to - view.from) * span;
    look(start, start + span);
  }
  function move(share) {
    const step = share * (view.to - view.from);
    look(view.from + step, view.to + step);
  }
  function everything() {
    for (const panel of panels) panel.chosen = null;
    look(0, data.end);
  }

  function timeAt(canvas, clientX) {
    const box = canvas.getBoundingClientRect();
    const share = (clientX - box.left - LEFT) / (box.width - LEFT - RIGHT);
    return view.from + Math.min(1, Math.max(0, share)) * (view.to - view.from);
  }

  // A box zooms all panels in time, and its own in height.
  function listenToBoxes(panel) {
    const canvas = panel.canvas;
    gearidae.boxZoom(canvas, (event) => boxing || event.shiftKey, (from, to, down) => {
      const range = panel.range, tall = canvas.clientHeight - TOP - BOTTOM, left = canvas.getBoundingClientRect().left;
      const value = (y) => range[1] - (range[1] - range[0]) * Math.min(1, Math.max(0, (y - TOP) / tall));
      if (down && range) panel.chosen = [value(down[1]), value(down[0])];
      look(timeAt(canvas, left + from), timeAt(canvas, left + to));
    });
  }

  function chooseBoxes(wanted) {
    boxing = wanted;
    boxButton.setAttribute("aria-pressed", String(wanted));
    holder.classList.toggle("boxing", wanted);
  }

  function listen(canvas) {
    const fingers = new Map();
    canvas.addEventListener("pointerdown", (event) => {
      fingers.set(event.pointerId, event.clientX);
      canvas.setPointerCapture(event.pointerId);
    });
    canvas.addEventListener("pointermove", (event) => {
      cursor = timeAt(canvas, event.clientX);
      document.dispatchEvent(new CustomEvent("gearidae:cursor", { detail: cursor }));
      const before = [...fingers.values()];
      if (!fingers.has(event.pointerId)) { later(); return; }
      fingers.set(event.pointerId, event.clientX);
      const after = [...fingers.values()];
      if (after.length === 1) {
        const inner = canvas.clientWidth - LEFT - RIGHT;
        move((before[0] - after[0]) / inner);
      } else if (after.length === 2) {
        const wide = Math.abs(after[0] - after[1]);
        if (wide > 8) zoom(Math.abs(before[0] - before[1]) / wide, timeAt(canvas, (after[0] + after[1]) / 2));
      }
    });
    const release = (event) => fingers.delete(event.pointerId);
    canvas.addEventListener("pointerup", release);
    canvas.addEventListener("pointercancel", release);
    canvas.addEventListener("pointerleave", () => { if (!fingers.size) { cursor = null; later(); } });
    canvas.addEventListener("dblclick", everything);
    canvas.addEventListener("wheel", (event) => {
      if (!event.ctrlKey && document.activeElement !== canvas) return; // the page scrolls
      event.preventDefault();
      zoom(Math.exp(Math.sign(event.deltaY) * 0.2), timeAt(canvas, event.clientX));
    }, { passive: false });
    canvas.addEventListener("keydown", (event) => {
      const actions = {
        ArrowLeft: () => move(-0.2), ArrowRight: () => move(0.2), "+": () => zoom(0.5), "=": () => zoom(0.5),
        "-": () => zoom(2), "0": everything, b: () => chooseBoxes(!boxing), Home: () => look(0, view.to - view.from),
        End: () => look(data.end - (view.to - view.from), data.end),
      };
      const action = actions[event.key];
      if (!action || event.ctrlKey || event.metaKey || event.altKey) return;
      event.preventDefault();
      action();
    });
  }

  function saveTable() {
    const shown = panels.filter((panel) => !panel.box.hidden), chosen = seen().map((place) => drawn[place]);
    gearidae.save(gearidae.tableOf(data, shown, chosen, indices), "csv", "series");
  }

  function savePlot(panel) {
    gearidae.savePlot(panel.canvas, panel.title.textContent, LEFT, panel.name);
  }

  function toggle(panel, wanted) {
    panel.box.hidden = !wanted;
    panel.button.setAttribute("aria-pressed", String(wanted));
    later();
  }

  const controls = element("div", holder, "", { className: "controls" });
  for (const [sign, name, action] of [
    ["−", "zoom out", () => zoom(2)], ["+", "zoom in", () => zoom(0.5)], ["◀", "earlier", () => move(-0.4)],
    ["▶", "later", () => move(0.4)], ["all", "show everything", everything],
  ]) {
    const button = element("button", controls, sign, { type: "button", title: name });
    button.setAttribute("aria-label", name);
    button.addEventListener("click", action);
  }
  const boxButton = element("button", controls, "box zoom", { type: "button", title: "drag boxes to zoom into" });
  boxButton.setAttribute("aria-pressed", "false");
  boxButton.addEventListener("click", () => chooseBoxes(!boxing));
  gearidae.saveButtons(controls, [["CSV", "download the shown plots as a table", saveTable]]);
  // A piece of the line of a run, with its dashes.
  function swatchOf(parent, place) {
    const name = "http://www.w3.org/2000/svg", svg = document.createElementNS(name, "svg"), line = document.createElementNS(name, "path");
    svg.setAttribute("class", "swatch");
    svg.setAttribute("viewBox", "0 0 32 4");
    line.setAttribute("d", "M0 2H32");
    line.setAttribute("stroke-dasharray", DASHES[place % 7].join(" "));
    svg.dataset.place = place;
    svg.append(line);
    parent.append(svg);
  }

  const legend = element("div", holder, "", { className: "controls" });
  function writeLegend() {
    legend.replaceChildren();
    for (const place of data.runs.length < 2 ? [] : places()) {
      const number = drawn[place], button = element("button", legend, "", { type: "button" });
      swatchOf(button, place);
      button.append(data.runs[number].label);
      button.setAttribute("aria-pressed", String(!hidden.has(number)));
      button.addEventListener("click", () => {
        if (!hidden.delete(number)) hidden.add(number);
        button.setAttribute("aria-pressed", String(!hidden.has(number)));
        later();
      });
    }
  }

  // Takes a run up or out; where all places are taken, it gets that of the run which is there longest. One stays.
  function choose(number) {
    near = number;
    const place = drawn.indexOf(number), free = drawn.indexOf(null);
    if (place < 0) {
      drawn[free < 0 ? drawn.indexOf(since.shift()) : free] = number;
      since.push(number);
    } else if (since.length > 1) {
      drawn[place] = null;
      since.splice(since.indexOf(number), 1);
      hidden.delete(number);
    }
    writeLegend();
    showChoice();
    later();
  }
  const showChoice = () => {
    if (showMap) showMap(near, since, (number) => (drawn.includes(number) ? colour(drawn.indexOf(number)) : ""));
  };
  const choice = document.getElementById("choice");
  // Of more than two dimensions the map shows a part: a list for each of the others chooses which.
  const others = choice ? data.outcomes.dims.slice(0, -2) : [];
  const lists = others.map((dim, k) => {
    const label = element("label", choice, dim.name + " "), list = element("select", label);
    dim.values.forEach((value, place) => element("option", list, value, { value: place }));
    list.addEventListener("change", () => {
      near = gearidae.runAt(data.outcomes, gearidae.placesOf(data.outcomes, near).map((at, i) => (i === k ? Number(list.value) : at)));
      showChoice();
    });
    return list;
  });
  const showMap = choice ? gearidae.outcomeMap(choice, data.outcomes, choose) : null;
  gearidae.placesOf(data.outcomes, near).slice(0, lists.length).forEach((place, k) => { lists[k].value = place; });
  if (data.runs.length > data.most) {
    element("p", choice, "All " + data.runs.length + " runs are in the page, " + data.most + " are drawn at a time: choose them on the map. Another one takes the place of the one that was chosen first; a second click takes a run out.", { className: "hint" });
  }
  writeLegend();
  showChoice();
  const readout = element("output", holder);
  const quantities = element("div", holder, "", { className: "controls" });
  for (const series of data.series) {
    const box = element("div", holder, "", { className: "plot" });
    const panel = { box, name: series.name, label: series.label, unit: series.unit };
    const unpacked = new Map(); // when first looked at
    panel.valuesOf = (run) => {
      if (!unpacked.has(run)) unpacked.set(run, decode(series.runs[run]));
      return unpacked.get(run);
    };
    panel.title = element("h3", box, series.label);
    panel.canvas = element("canvas", box, "", { tabIndex: 0 });
    panel.canvas.setAttribute("role", "img");
    panel.canvas.setAttribute("aria-label", series.label + " over time; arrow keys move, plus and minus zoom, 0 shows all");
    panel.button = element("button", quantities, series.name.replaceAll("_", " "), { type: "button" });
    panel.button.addEventListener("click", () => toggle(panel, box.hidden));
    listenToBoxes(panel);
    listen(panel.canvas);
    gearidae.saveButtons(box, [["PNG", "download the plot of " + series.label, () => savePlot(panel)]]);
    panels.push(panel);
    toggle(panel, series.shown);
  }
  const notes = [];
  if (data.reduced > 1) notes.push("Of every " + data.reduced + " samples the page holds the smallest and the largest.");
  notes.push("Marks at the foot: contacts made (long) and broken (short).");
  element("p", holder, notes.join(" "), { className: "hint" });

  // The time at which the teeth are shown.
  document.addEventListener("gearidae:teeth", (event) => { followed = event.detail; later(); });
  whenSeenAnew(() => { showChoice(); drawAll(); }, later);
  drawAll();
})();
