// The teeth in mesh: both gears to scale, and the pairs that meet close up. Follows the time series' cursor.
(() => {
  "use strict";
  const { decode, element, style, colour, seconds, quantity, soon, whenSeenAnew, penOf } = gearidae;
  const { COAST, onLine, drawNear, drawForce } = gearidae.mesh;
  const holder = document.getElementById("teeth-viewer");
  const source = document.getElementById("teeth-data");
  if (!holder || !source) return;
  const data = JSON.parse(source.textContent);
  const BELOW = 3.5, ABOVE = 12; // roughnesses
  const OPEN = 0, LOADING = 1, PARTLY = 2, FULLY = 3;
  const FRAME = data.columns.frame.length, PAIR = data.columns.pair.length;
  let run = null, frame = 0, view = null;

  function take(number) {
    run = data.runs[number];
    if (!run.rows) {
      run.numbers = decode(run.states);
      run.size = FRAME + PAIR * run.places;
      run.rows = run.numbers.length / run.size;
      run.rowsOfAsperities = run.asperities.map(decode);
      run.joinedAsperities = decode(run.joined);
      run.largest = 0;
      for (let i = 0; i < run.rows; i++) {
        for (const pair of pairsOf(i)) run.largest = Math.max(run.largest, Math.abs(pair.force));
      }
    }
    frame = Math.min(frame, run.rows - 1);
    slider.max = run.rows - 1;
  }

  function frameOf(index) {
    const found = {};
    data.columns.frame.forEach((name, k) => { found[name] = run.numbers[run.size * index + k]; });
    return found;
  }

  function pairsOf(index) {
    const found = [];
    for (let place = 0; place < run.places; place++) {
      const start = run.size * index + FRAME + PAIR * place;
      if (Number.isNaN(run.numbers[start])) continue;
      const pair = { place_in_row: place };
      data.columns.pair.forEach((name, k) => { pair[name] = run.numbers[start + k]; });
      pair.state = Math.max(...[pair.bare, pair.coated, pair.mixed].filter((state) => !Number.isNaN(state)));
      found.push(pair);
    }
    return found;
  }

  const nearest = (time) => Math.max(0, Math.min(run.rows - 1, Math.round(time / frameOf(run.rows - 1).time * (run.rows - 1)) || 0));

  function drawMesh(now, pairs) {
    const used = pairs.length && pairs[0].flank === COAST ? COAST : 0;
    const motion = { travel: now.travel * run.pitch, error: now.transmission_error, speed: now.gear_speed };
    const near = drawNear(mesh, run, motion, used);
    if (!near) return;
    for (const pair of pairs) if (pair.state !== OPEN) drawForce(near, run, pair.flank, pair.place, pair.force, run.largest);
    for (const pair of pairs) mark(near.pen, pair, near.at);
  }

  const faceOf = (state) => ({ [OPEN]: style("--ground"), [LOADING]: colour(0), [PARTLY]: colour(4), [FULLY]: colour(1) })[state] || style("--faint");

  function symbol(pen, state, a, b) {
    pen.fillStyle = faceOf(state);
    pen.strokeStyle = style("--ink");
    pen.lineWidth = 1.5;
    pen.beginPath();
    if (state === PARTLY) { pen.moveTo(a, b - 7); pen.lineTo(a + 7, b + 6); pen.lineTo(a - 7, b + 6); pen.closePath(); }
    else if (state === FULLY) pen.rect(a - 6, b - 6, 12, 12);
    else pen.arc(a, b, 6, 0, 2 * Math.PI);
    pen.fill();
    pen.stroke();
  }

  function mark(pen, pair, at) {
    const [a, b] = at(onLine(run, pair.flank, pair.place));
    symbol(pen, pair.state, a, b);
    pen.fillStyle = style("--ground");
    pen.beginPath(); pen.arc(a + 9, b - 24, 11, 0, 2 * Math.PI); pen.fill();
    pen.fillStyle = style("--ink");
    pen.textAlign = "center";
    pen.font = "bold 13px system-ui, sans-serif";
    pen.fillText(String(pair.number), a + 9, b - 24);
  }

  // The asperities beside a pair that its row holds; x is counted from where the pair touches.
  function bumpsOf(pair, reach) {
    const row = run.rowsOfAsperities[pair.row], count = row.length / 4, found = [];
    for (let k = 0; k < count; k++) {
      const x = row[k] - pair.arc;
      if (Math.abs(x) < reach) found.push({ x, height: row[count + k], radius: row[2 * count + k], material: row[3 * count + k] });
    }
    return found;
  }

  function joinedOf(pair) {
    const found = [];
    for (let k = pair.joined_from; k < pair.joined_to; k++) found.push({ x: run.joinedAsperities[2 * k] - pair.arc, height: run.joinedAsperities[2 * k + 1] });
    return found;
  }

  function isJoined(pair, bump) {
    return [pair.joined_bare, pair.joined_coated, pair.joined_mixed][bump.material] + bump.x ** 2 / (2 * pair.radius) < bump.height;
  }

  function arrowhead(pen, a, b, ink) {
    pen.fillStyle = ink;
    pen.strokeStyle = style("--ground");
    pen.lineWidth = 1;
    pen.beginPath(); pen.moveTo(a, b + 5); pen.lineTo(a - 5, b - 5); pen.lineTo(a + 5, b - 5); pen.closePath();
    pen.fill();
    pen.stroke();
  }

  // One pair close up: asperities of the one flank under the smooth other, heights stretched.
  function drawClose(box, pair) {
    box.figure.hidden = !pair;
    if (!pair) return;
    const sheet = penOf(box.canvas);
    if (!sheet) return;
    const { pen, width, height } = sheet;
    const sigma = run.roughness, half = run.halfWidth, top = Math.max(ABOVE * sigma, pair.gap + BELOW * sigma);
    const x = (a) => width * (a + half) / (2 * half), y = (b) => height * (top - b) / (top + BELOW * sigma);
    const bumps = bumpsOf(pair, 1.1 * half), upper = (a) => pair.gap + a * a / (2 * pair.radius);
    const lower = [];
    for (let i = 0; i <= width; i += 1) {
      const a = (2 * i / width - 1) * half;
      let height = -BELOW * sigma, coated = false;
      for (const bump of bumps) {
        const cap = bump.height - (a - bump.x) ** 2 / (2 * bump.radius);
        if (cap > height) { height = cap; coated = bump.material > 0; }
      }
      lower.push({ a, height: Math.min(height, upper(a)), pressed: height > upper(a), coated });
    }
    pen.strokeStyle = style("--ink");
    const [rough, smooth] = run.population ? ["--pinion", "--gear"] : ["--gear", "--pinion"]; // a population stands on the pinion
    for (const [fill, edge, line] of [[rough, height, (one) => one.height], [smooth, 0, (one) => upper(one.a)]]) {
      pen.beginPath();
      for (const one of lower) pen.lineTo(x(one.a), y(line(one)));
      pen.lineWidth = 1.2;
      pen.stroke();
      pen.lineTo(width, edge);
      pen.lineTo(0, edge);
      pen.fillStyle = style(fill);
      pen.fill();
    }
    for (const [wanted, ink, thick] of [["coated", 2, 3], ["pressed", 0, 5]]) {
      pen.strokeStyle = colour(ink);
      pen.lineWidth = thick;
      pen.beginPath();
      lower.forEach((one, i) => {
        if (!one[wanted]) return;
        if (i === 0 || !lower[i - 1][wanted]) pen.moveTo(x(one.a), y(one.height)); else pen.lineTo(x(one.a), y(one.height));
      });
      pen.stroke();
    }
    pen.strokeStyle = colour(1);
    pen.lineWidth = 4;
    pen.beginPath();
    const joined = run.population ? joinedOf(pair) : bumps.filter((bump) => isJoined(pair, bump));
    for (const bump of joined) {
      if (bump.height >= upper(bump.x)) continue;
      pen.moveTo(x(bump.x), y(bump.height));
      pen.lineTo(x(bump.x), y(upper(bump.x)));
    }
    pen.stroke();
    if (run.population) for (const bump of joined) arrowhead(pen, x(bump.x), y(upper(bump.x)), colour(bump.height < upper(bump.x) ? 1 : 0));
    pen.strokeStyle = style("--ink");
    pen.lineWidth = 1;
    pen.setLineDash([4, 3]);
    pen.beginPath(); pen.moveTo(0, y(0)); pen.lineTo(width, y(0)); pen.stroke();
    pen.setLineDash([]);
    pen.beginPath(); pen.moveTo(width / 2, y(0)); pen.lineTo(width / 2, y(pair.gap)); pen.stroke();
    const factor = (height / (top + BELOW * sigma)) / (width / (2 * half));
    box.caption.textContent = wordsOf(pair).join("; ");
    box.scale.textContent = quantity(2 * half, "m", 3) + " across; heights × " + factor.toPrecision(2);
  }

  function wordsOf(pair) {
    const words = ["Pair " + pair.number + ", " + (pair.flank === COAST ? "coast" : "drive") + " flank: gap " + quantity(pair.gap, "m")];
    words.push(pair.force === 0 ? "no force" : (pair.force > 0 ? "pushes with " : "pulls with ") + quantity(Math.abs(pair.force), "N"));
    const parts = [["bare", pair.bare], ["monolayer", pair.coated], ["monolayer on bare", pair.mixed]].filter((part) => !Number.isNaN(part[1]));
    const same = parts.every((part) => part[1] === parts[0][1]);
    words.push(same ? data.words[parts[0][1]] : parts.map(([name, state]) => name + " " + data.words[state]).join(", "));
    const expected = pair.count < 1e-3 ? pair.count.toExponential(1) : pair.count.toPrecision(2);
    if (Number.isFinite(pair.count)) words.push(run.population ? "joined asperities: " + pair.count : "expected asperities in contact " + expected);
    return words;
  }

  function draw() {
    const now = frameOf(frame), pairs = pairsOf(frame);
    drawMesh(now, pairs);
    close.forEach((box, place) => drawClose(box, pairs.find((pair) => pair.place_in_row === place)));
    slider.value = frame;
    slider.setAttribute("aria-valuetext", seconds(now.time));
    readout.textContent = "t = " + seconds(now.time) + "  ·  gear " + now.gear_speed.toPrecision(4) + " rad/s  ·  force of all pairs "
      + quantity(now.mesh_force, "N");
    for (const [canvas, state] of key) {
      const sheet = penOf(canvas);
      if (sheet) symbol(sheet.pen, state, 9, 9);
    }
  }

  const later = soon(draw);

  function show(index, tell) {
    frame = Math.max(0, Math.min(run.rows - 1, index));
    if (tell) document.dispatchEvent(new CustomEvent("gearidae:teeth", { detail: frameOf(frame).time }));
    later();
  }

  // What is in view of the time series is played.
  const inView = () => [nearest(view ? view.from : 0), nearest(view ? view.to : frameOf(run.rows - 1).time)];
  const { controls, slider, stop } = gearidae.player(holder, "time of the picture of the teeth", () => frame, inView, (index) => show(index, true));
  if (data.runs.length > 1) {
    const choice = element("select", controls, "", {});
    choice.setAttribute("aria-label", "run shown");
    data.runs.forEach((one, number) => element("option", choice, one.label, { value: number }));
    choice.addEventListener("change", () => {
      const time = frameOf(frame).time;
      stop();
      take(Number(choice.value));
      show(nearest(time), true);
    });
  }
  const readout = element("output", holder);
  const mesh = element("canvas", holder, "", { className: "mesh" });
  mesh.setAttribute("role", "img");
  mesh.setAttribute("aria-label", "both gears near the pitch point, to scale; what the pairs do is written below");
  const legend = element("p", holder, "", { className: "key" });
  const key = Object.entries(data.words).map(([state, words]) => [Number(state), words]).sort((a, b) => a[0] - b[0]).map(([state, words]) => {
    const entry = element("span", legend), canvas = element("canvas", entry);
    entry.append(words);
    return [canvas, state];
  });
  const row = element("div", holder, "", { className: "close-ups" });
  const close = Array.from({ length: Math.max(...data.runs.map((one) => one.places)) }, () => {
    const figure = element("figure", row), canvas = element("canvas", figure);
    canvas.setAttribute("role", "img");
    canvas.setAttribute("aria-label", "the flanks of a pair close up");
    return { figure, canvas, caption: element("figcaption", figure), scale: element("p", figure, "", { className: "hint" }) };
  });
  take(0);
  const notes = [];
  if (run.gaps !== 1) notes.push("Gaps, and errors of single teeth, × " + run.gaps + ".");
  if (run.every > 1) notes.push("One of every " + run.every + " samples is shown.");
  notes.push("Blue pushes or is pressed, orange pulls or is stretched, green is covered by the monolayer. Arrows: force of a pair on the gear.");
  if (run.population) notes.push("The close-ups show the tallest asperities of each flank, all that stand side by side across its width; triangles mark the joined ones.");
  else notes.push("The asperities are a sample with the model's density and heights; single asperities are not recorded.");
  element("p", holder, notes.join(" "), { className: "hint" });

  document.addEventListener("gearidae:cursor", (event) => { stop(); show(nearest(event.detail), false); });
  document.addEventListener("gearidae:view", (event) => { view = event.detail; });
  whenSeenAnew(draw, later);
  draw();
})();
