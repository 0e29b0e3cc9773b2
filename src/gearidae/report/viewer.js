// Time series of a report: panels over one common time axis. No library, no network.
(() => {
  "use strict";
  const { decode, element, prefixOf, ticks, readable, style, colour, seconds, whenSeenAnew, penOf } = gearidae;
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
  let cursor = null, followed = null, waiting = false, boxing = false;

  function later() {
    if (waiting) return;
    waiting = true;
    requestAnimationFrame(() => { waiting = false; drawAll(); });
  }

  function drawAll() {
    for (const panel of panels) if (panel.values && !panel.box.hidden) draw(panel);
    legend.querySelectorAll(".swatch").forEach((swatch, run) => { swatch.style.color = colour(run); });
    report();
  }

  // Extremes of what is in view, so that the scale follows the zoom.
  function rangeOf(panel) {
    if (panel.chosen) return panel.chosen;
    let low = Infinity, high = -Infinity;
    panel.values.forEach((values, run) => {
      if (hidden.has(run)) return;
      const [first, last] = indices(values);
      for (let i = first; i <= last; i++) {
        const value = values[i];
        if (value < low) low = value;
        if (value > high) high = value;
      }
    });
    if (!(low <= high)) return null;
    const margin = 0.05 * (high - low) || 0.05 * Math.abs(high) || 1;
    return [low - margin, high + margin];
  }

  // The liveliest run goes to the back, so that it does not hide the others.
  function byLiveliness(panel) {
    const spread = panel.values.map((values) => {
      const [first, last] = indices(values);
      let low = Infinity, high = -Infinity;
      for (let i = first; i <= last; i++) {
        if (values[i] < low) low = values[i];
        if (values[i] > high) high = values[i];
      }
      return high - low;
    });
    return [...panel.values.keys()].filter((run) => !hidden.has(run)).sort((a, b) => spread[b] - spread[a]);
  }

  function indices(values) {
    const step = data.end / (values.length - 1 || 1);
    return [Math.max(0, Math.floor(view.from / step)), Math.min(values.length - 1, Math.ceil(view.to / step))];
  }

  function draw(panel) {
    const sheet = penOf(panel.canvas);
    if (!sheet) return;
    const { pen, width, height } = sheet;
    pen.font = "12px system-ui, sans-serif";
    const inner = width - LEFT - RIGHT, tall = height - TOP - BOTTOM;
    const x = (time) => LEFT + inner * (time - view.from) / (view.to - view.from);
    pen.fillStyle = style("--faint");
    pen.strokeStyle = style("--line");
    pen.lineWidth = 1;

    const seconds = prefixOf(Math.max(Math.abs(view.from), Math.abs(view.to)));
    const across = ticks(view.from * seconds.factor, view.to * seconds.factor, inner / 90);
    pen.textAlign = "center";
    pen.textBaseline = "top";
    for (const tick of across.found) {
      const at = x(tick / seconds.factor);
      pen.beginPath(); pen.moveTo(at, TOP); pen.lineTo(at, TOP + tall); pen.stroke();
      if (at < LEFT + inner - 24) pen.fillText(tick.toFixed(across.digits), at, TOP + tall + 6);
    }
    pen.textAlign = "right";
    pen.fillText(seconds.prefix + "s", width - RIGHT, TOP + tall + 6);

    const range = panel.range = rangeOf(panel);
    if (!range) return;
    const scale = panel.unit ? prefixOf(Math.max(Math.abs(range[0]), Math.abs(range[1]))) : { factor: 1, prefix: "" };
    panel.title.textContent = panel.label + (panel.unit ? " (" + readable(scale.prefix, panel.unit) + ")" : "");
    const y = (value) => TOP + tall * (range[1] - value) / (range[1] - range[0]);
    const up = ticks(range[0] * scale.factor, range[1] * scale.factor, tall / 32);
    pen.textBaseline = "middle";
    for (const tick of up.found) {
      const at = y(tick / scale.factor);
      pen.beginPath(); pen.moveTo(LEFT, at); pen.lineTo(LEFT + inner, at); pen.stroke();
      pen.fillText(tick.toFixed(up.digits), LEFT - 6, at);
    }

    pen.save();
    pen.beginPath(); pen.rect(LEFT, TOP, inner, tall); pen.clip();
    for (const run of byLiveliness(panel)) trace(pen, panel.values[run], run, x, y, inner);
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
  function trace(pen, values, run, x, y, inner) {
    const [first, last] = indices(values), step = data.end / (values.length - 1 || 1);
    const perColumn = (last - first + 1) / Math.max(inner, 1);
    pen.strokeStyle = colour(run);
    pen.lineWidth = 1.4;
    pen.setLineDash(perColumn > 2 ? [] : DASHES[run % 7]);
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
    data.runs.forEach((run, number) => {
      if (hidden.has(number)) return;
      pen.strokeStyle = colour(number);
      for (const [times, length] of [[run.onsets, 10], [run.separations, 5]]) {
        pen.beginPath();
        for (const time of times) {
          if (time < view.from || time > view.to) continue;
          pen.moveTo(x(time), foot); pen.lineTo(x(time), foot - length);
        }
        pen.stroke();
      }
    });
  }

  function report() {
    if (cursor === null) {
      readout.textContent = "Showing " + seconds(view.from) + " to " + seconds(view.to);
      return;
    }
    const parts = ["t = " + seconds(cursor)];
    for (const panel of panels) {
      if (!panel.values || panel.box.hidden) continue;
      panel.values.forEach((values, run) => {
        if (hidden.has(run)) return;
        const value = values[Math.round(cursor / data.end * (values.length - 1))];
        const scale = panel.unit ? prefixOf(Math.abs(value)) : { factor: 1, prefix: "" };
        const label = data.runs.length > 1 ? " [" + data.runs[run].label + "]" : "";
        const shown = Number.isNaN(value) ? "not reached" : (value * scale.factor).toPrecision(5);
        parts.push(panel.name.replaceAll("_", " ") + label + " " + shown + " " + readable(scale.prefix, panel.unit));
      });
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
    const shown = panels.filter((panel) => panel.values && !panel.box.hidden);
    gearidae.save(gearidae.tableOf(data, shown, hidden, indices), "csv", "series");
  }

  function savePlot(panel) {
    gearidae.savePlot(panel.canvas, panel.title.textContent, LEFT, panel.name);
  }

  function toggle(panel, wanted) {
    panel.box.hidden = !wanted;
    panel.button.setAttribute("aria-pressed", String(wanted));
    if (wanted && !panel.values) panel.values = panel.packed.map(decode); // unpacked when first looked at
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
  // A piece of a run's line, with its dashes.
  function swatchOf(parent, dashes) {
    const name = "http://www.w3.org/2000/svg", svg = document.createElementNS(name, "svg"), line = document.createElementNS(name, "path");
    svg.setAttribute("class", "swatch");
    svg.setAttribute("viewBox", "0 0 32 4");
    line.setAttribute("d", "M0 2H32");
    line.setAttribute("stroke-dasharray", dashes.join(" "));
    svg.append(line);
    parent.append(svg);
  }

  const legend = element("div", holder, "", { className: "controls" });
  data.runs.forEach((run, number) => {
    if (data.runs.length < 2) return;
    const button = element("button", legend, "", { type: "button" });
    swatchOf(button, DASHES[number % 7]);
    button.append(run.label);
    button.setAttribute("aria-pressed", "true");
    button.addEventListener("click", () => {
      if (!hidden.delete(number)) hidden.add(number);
      button.setAttribute("aria-pressed", String(!hidden.has(number)));
      later();
    });
  });
  const readout = element("output", holder);
  const quantities = element("div", holder, "", { className: "controls" });
  for (const series of data.series) {
    const box = element("div", holder, "", { className: "plot" });
    const panel = { box, name: series.name, label: series.label, unit: series.unit, packed: series.runs };
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
  if (data.of > data.runs.length) notes.push(data.runs.length + " of " + data.of + " runs are shown: the first, the last, and those at which the outcome changes.");
  if (data.reduced > 1) notes.push("Of every " + data.reduced + " samples the page holds the smallest and the largest.");
  notes.push("Marks at the foot: contacts made (long) and broken (short).");
  element("p", holder, notes.join(" "), { className: "hint" });

  // The time at which the teeth are shown.
  document.addEventListener("gearidae:teeth", (event) => { followed = event.detail; later(); });
  whenSeenAnew(drawAll, later);
  drawAll();
})();
