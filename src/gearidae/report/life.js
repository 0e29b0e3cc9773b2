// The life of a coating: a slider over passages, coverage and frequency there, coverage along the flank by tooth.
(() => {
  "use strict";
  const source = document.getElementById("life-data"), root = document.getElementById("life-viewer");
  if (!source || !root) return;
  const { decode, element, style, colour, quantity, whenSeenAnew, penOf } = gearidae;
  const data = JSON.parse(source.textContent);
  const STEPS = 1000, LEFT = 58, RIGHT = 52, TOP = 10, BOTTOM = 34, FONT = "12px system-ui, sans-serif";
  const last = data.passages.length - 1, end = Math.max(data.sticksBy || 0, data.passages[last]) || 1;
  const tables = (data.tables || []).map(decode);
  let at = 0;

  const controls = element("div", root, "", { className: "controls" });
  const button = (words, label, action) => {
    const made = element("button", controls, words, { type: "button", onclick: action });
    made.setAttribute("aria-label", label);
  };
  button("‹", "step before", () => show(Math.max(...data.passages.filter((each) => each < at - 1e-9 * end), 0)));
  const slider = element("input", controls, "", { type: "range", min: 0, max: STEPS, step: 1, value: 0 });
  slider.setAttribute("aria-label", "passages of each tooth of the pinion");
  button("›", "next step", () => show(Math.min(...data.passages.filter((each) => each > at + 1e-9 * end), data.passages[last])));
  const reading = element("output", root, "");
  const curves = sheet("Coverage (left) and frequency of the impact response (right) over passages");
  const flanks = tables.map((_, side) => sheet("Coverage of the " + data.sides[side] + " along the path of contact" + (data.teeth > 1 ? ", by tooth of the pinion" : "")));

  function sheet(words) {
    const figure = element("figure", root, "");
    const canvas = element("canvas", figure, "");
    canvas.setAttribute("role", "img");
    canvas.setAttribute("aria-label", words);
    element("figcaption", figure, words);
    return canvas;
  }

  // The step that a number of passages has reached, and how far it is on the way to the next.
  function before(passages) {
    let number = 0;
    while (number < last && data.passages[number + 1] <= passages) number++;
    return number;
  }
  function blend(passages) {
    const first = before(passages), next = Math.min(first + 1, last);
    const span = data.passages[next] - data.passages[first];
    return { first, next, share: span > 0 ? Math.min((passages - data.passages[first]) / span, 1) : 0 };
  }
  function value(numbers, where) {
    const a = numbers[where.first], b = numbers[where.next];
    if (a === null) return null;
    return b === null ? a : a + where.share * (b - a);
  }

  function show(passages) {
    at = passages;
    slider.value = Math.round(STEPS * at / end);
    const where = blend(at), words = [];
    data.sides.forEach((side, number) => words.push((data.sides.length > 1 ? side + " " : "coverage ") + (100 * value(data.coverage[number], where)).toFixed(1) + " %"));
    const sticks = data.sticksBy !== null && (at >= data.sticksBy || data.verdict[where.first] === "sticks");
    const unknown = data.sticksBy !== null && !sticks && at > data.passages[last];
    words.push(sticks ? "sticks" : unknown ? "turns or sticks already" : data.verdict[where.first]);
    if (!sticks) {
      words.push("mean speed " + value(data.mean, where).toPrecision(4) + " rad/s", "smallest " + value(data.smallest, where).toPrecision(4) + " rad/s");
      const rings = data.frequency && value(data.frequency, where);
      if (rings) words.push("rings at " + quantity(rings, "Hz"));
    }
    reading.textContent = Number(at.toPrecision(3)).toExponential() + " passages: " + words.join(", ");
    slider.setAttribute("aria-valuetext", reading.textContent);
    draw();
  }

  function axes(pen, width, height, marks) {
    pen.font = FONT;
    pen.strokeStyle = style("--line");
    pen.lineWidth = 1;
    pen.strokeRect(LEFT, TOP, width - LEFT - RIGHT, height - TOP - BOTTOM);
    pen.fillStyle = style("--faint");
    pen.textBaseline = "middle";
    pen.textAlign = "right";
    for (const [words, share] of marks) pen.fillText(words, LEFT - 6, height - BOTTOM - share * (height - TOP - BOTTOM));
  }

  function below(pen, width, height, first, words, final) {
    pen.fillStyle = style("--faint");
    pen.textBaseline = "top";
    for (const [text, align, x] of [[first, "left", LEFT], [words, "center", (LEFT + width - RIGHT) / 2], [final, "right", width - RIGHT]]) {
      pen.textAlign = align;
      pen.fillText(text, x, height - BOTTOM + 8);
    }
  }

  function line(pen, points, hue, dashes) {
    pen.setLineDash(dashes);
    pen.strokeStyle = hue;
    pen.lineWidth = 2;
    pen.beginPath();
    for (const [x, y] of points) pen.lineTo(x, y);
    pen.stroke();
    pen.setLineDash([]);
  }

  function drawCurves() {
    const paper = penOf(curves);
    if (!paper) return;
    const { pen, width, height } = paper, wide = width - LEFT - RIGHT, tall = height - TOP - BOTTOM;
    const x = (passages) => LEFT + wide * passages / end, y = (share) => height - BOTTOM - tall * share;
    axes(pen, width, height, [["0 %", 0], ["50 %", 0.5], ["100 %", 1]]);
    below(pen, width, height, "0", "passages", end.toExponential(2));
    if (data.sticksBy !== null) {
      pen.fillStyle = style("--line");
      pen.fillRect(x(data.passages[last]), TOP, Math.max(wide * (data.sticksBy - data.passages[last]) / end, 1), tall);
    }
    data.coverage.forEach((numbers, side) => line(pen, data.passages.map((n, k) => [x(n), y(numbers[k])]), colour(side), []));
    const rings = data.frequency && Math.max(...data.frequency.filter((each) => each !== null));
    if (rings > 0) {
      const points = data.passages.map((n, k) => [x(n), data.frequency[k]]).filter(([, each]) => each !== null);
      line(pen, points.map(([n, each]) => [n, y(each / rings)]), colour(4), [6, 4]);
      pen.fillStyle = style("--faint");
      pen.textAlign = "left";
      pen.textBaseline = "middle";
      pen.fillText("0", width - RIGHT + 6, y(0));
      pen.fillText(quantity(rings, "Hz", 2), width - RIGHT + 4, y(1) + 4);
    }
    line(pen, [[x(at), TOP], [x(at), height - BOTTOM]], style("--accent"), []);
  }

  const mixed = (share) => "color-mix(in srgb, " + style("--accent") + " " + (100 * share).toFixed(1) + "%, " + style("--ground") + ")";

  function drawFlank(canvas, table) {
    const paper = penOf(canvas);
    if (!paper) return;
    const { pen, width, height } = paper, wide = width - LEFT - RIGHT, tall = height - TOP - BOTTOM;
    const where = blend(at), places = data.places.length, size = data.teeth * places;
    const share = (tooth, place) => {
      const k = tooth * places + place, a = table[where.first * size + k];
      return a + where.share * (table[where.next * size + k] - a);
    };
    const range = Math.max(data.high - data.low, 1e-6), ends = [data.low, data.high].map((each) => (100 * each).toFixed(0) + " %");
    const micro = (metres) => (1e6 * metres).toFixed(0) + " µm";
    if (data.teeth === 1) {
      axes(pen, width, height, [["0 %", 0], ["50 %", 0.5], ["100 %", 1]]);
      line(pen, data.places.map((_, k) => [LEFT + wide * (k + 0.5) / places, height - BOTTOM - tall * share(0, k)]), colour(0), []);
    } else {
      axes(pen, width, height, [["tooth 0", 0.5 / data.teeth], [String(data.teeth - 1), 1 - 0.5 / data.teeth]]);
      for (let tooth = 0; tooth < data.teeth; tooth++) for (let place = 0; place < places; place++) {
        pen.fillStyle = mixed((share(tooth, place) - data.low) / range);
        pen.fillRect(LEFT + wide * place / places, height - BOTTOM - tall * (tooth + 1) / data.teeth, wide / places + 0.5, tall / data.teeth + 0.5);
      }
      for (let k = 0; k < 40; k++) {
        pen.fillStyle = mixed(k / 39);
        pen.fillRect(width - RIGHT + 8, height - BOTTOM - tall * (k + 1) / 40, 10, tall / 40 + 0.5);
      }
      pen.fillStyle = style("--faint");
      pen.textAlign = "left";
      pen.textBaseline = "middle";
      pen.fillText(ends[0], width - RIGHT + 21, height - BOTTOM - 5);
      pen.fillText(ends[1], width - RIGHT + 21, TOP + 5);
    }
    below(pen, width, height, micro(data.places[0]), "place", micro(data.places[places - 1]));
  }

  function draw() {
    drawCurves();
    flanks.forEach((canvas, side) => drawFlank(canvas, tables[side]));
  }

  slider.addEventListener("input", () => show(end * slider.value / STEPS));
  const pointed = (event) => {
    const box = curves.getBoundingClientRect(), share = (event.clientX - box.left - LEFT) / (box.width - LEFT - RIGHT);
    show(end * Math.min(Math.max(share, 0), 1));
  };
  curves.addEventListener("pointerdown", (event) => { curves.setPointerCapture(event.pointerId); pointed(event); });
  curves.addEventListener("pointermove", (event) => { if (event.buttons) pointed(event); });
  whenSeenAnew(draw, () => requestAnimationFrame(draw));
  show(0);
})();
