// A train for the page of runs: its gears about their centres, loads of the hubs, what each mesh does, and a scale; lengths in µm.
(() => {
  "use strict";
  const { style, colour, quantity, element, penOf } = gearidae;
  const { arrow, wholeOf } = gearidae.mesh;
  const MARGIN = 1.04, NEAR = 5; // of a gear around the train; modules to either side of a pitch point

  // What explorer.js shows of the data of trains; figureOf(words, name) makes a canvas in a figure, later() draws anew.
  gearidae.explored = (data, figureOf, parent, later) => {
    const shafts = data.shafts.length;
    const speedOf = (state, k) => Number(state.speed[k].toPrecision(4)) + " rad/s";
    const canvas = figureOf("the gears of the train", "train");
    const caption = element("figcaption", canvas.parentElement);
    const choice = element("label", caption, "Show "), select = element("select", choice);
    for (const words of ["the whole train", ...data.meshes.map((name) => "mesh " + name)]) element("option", select, words);
    select.addEventListener("change", later);
    element("span", caption, " To scale, gaps too; a dot marks tooth 0 of each gear. Arrows: loads of the hubs, the longest " + quantity(data.largest, "N", 3) +
      ". Pitch points: blue pushes, orange pulls, empty does not touch.");
    const values = element("div", parent, "", { className: "values" });
    const tableOf = (words, headings, rows) => {
      const table = element("table", element("div", values, "", { className: "wide" })), head = element("tr", element("thead", table));
      table.setAttribute("aria-label", words);
      headings.forEach((heading, k) => element("th", head, heading, { scope: "col", className: k ? "number" : "" }));
      const body = element("tbody", table);
      return rows.map((name, k) => {
        const row = element("tr", body), first = element("th", row, "", { scope: "row" });
        gearidae.keyOf(first, name, k);
        return headings.slice(1).map(() => element("td", row, "", { className: "number" }));
      });
    };
    const cells = {
      shafts: tableOf("shafts", ["shaft", "speed", "load of the hub", "direction"], data.shafts),
      meshes: tableOf("meshes", ["mesh", "force", "teeth"], data.meshes),
    };

    // Left, right, lower and upper end of what is shown: all, or what lies near a pitch point.
    function bounds(gears, pitch) {
      if (pitch) {
        const [x, y] = pitch.at, reach = NEAR * pitch.module;
        return [x - reach, x + reach, y - reach, y + reach];
      }
      const ends = (k, way) => gears.wheels.map((wheel) => wheel.centre[k] + way * MARGIN * wheel.reach);
      return [Math.min(...ends(0, -1)), Math.max(...ends(0, 1)), Math.min(...ends(1, -1)), Math.max(...ends(1, 1))];
    }

    function drawTrain(state, gears) {
      const sheet = penOf(canvas);
      if (!sheet) return;
      const { pen, width, height } = sheet, pitch = gears.pitches[select.selectedIndex - 1], [low, high, bottom, top] = bounds(gears, pitch);
      const size = Math.min(width / (high - low), height / (top - bottom));
      const at = ([a, b]) => [width / 2 + size * (a - (low + high) / 2), height / 2 - size * (b - (bottom + top) / 2)];
      gears.wheels.forEach((wheel, number) => {
        if (pitch && !pitch.wheels.includes(number)) return;
        const path = wholeOf(wheel, pitch ? 1 : 4);
        pen.save();
        pen.translate(...at(wheel.centre));
        pen.scale(size, -size);
        pen.rotate(wheel.sense * state.angle[wheel.shaft]);
        // the ground first, so that the gear behind shows through no more than a little
        pen.fillStyle = style("--ground");
        pen.globalAlpha = 0.8;
        pen.fill(path);
        pen.fillStyle = colour(wheel.shaft);
        pen.globalAlpha = 0.3;
        pen.fill(path);
        pen.globalAlpha = 1;
        pen.strokeStyle = pen.fillStyle = style("--ink");
        pen.lineWidth = 0.8 / size;
        pen.stroke(path);
        pen.beginPath(); pen.arc(...wheel.mark, 2.5 / size, 0, 2 * Math.PI); pen.fill();
        pen.restore();
      });
      gears.pitches.forEach((each, k) => {
        const force = state.force[k];
        pen.beginPath();
        pen.arc(...at(each.at), 4, 0, 2 * Math.PI);
        pen.fillStyle = state.pairs[k] === 0 ? style("--ground") : colour(force > 0 ? 0 : 1);
        pen.strokeStyle = style("--ink");
        pen.lineWidth = 1.2;
        pen.fill();
        pen.stroke();
      });
      const longest = data.arrows.longest * Math.hypot(width, height);
      gears.hubs.forEach((hub, k) => drawHub(pen, at(hub), k, state, longest));
      drawScale(pen, size, width, height);
    }

    // Dot, arrow and words of a hub; the words stand where the arrow does not point.
    function drawHub(pen, [x, y], k, state, longest) {
      const load = state.load[k], turned = state.direction[k];
      let down = true;
      pen.fillStyle = style("--ink");
      pen.beginPath(); pen.arc(x, y, 3, 0, 2 * Math.PI); pen.fill();
      if (load > data.arrows.least * data.largest) {
        const length = longest * Math.max(load / data.largest, data.arrows.shortest);
        arrow(pen, [x, y], [length * Math.cos(turned), -length * Math.sin(turned)], style("--ink"));
        down = Math.sin(turned) > 0;
      }
      const words = data.shafts[k];
      pen.font = "13px system-ui, sans-serif";
      pen.textAlign = "center";
      pen.textBaseline = "middle";
      const middle = y + (down ? 14 : -14), wide = pen.measureText(words).width + 6;
      pen.fillStyle = style("--panel");
      pen.globalAlpha = 0.8;
      pen.fillRect(x - wide / 2, middle - 8, wide, 16);
      pen.globalAlpha = 1;
      pen.fillStyle = style("--ink");
      pen.fillText(words, x, middle);
    }

    // A bar of a round length, less than a fifth of the width.
    function drawScale(pen, size, width, height) {
      const most = width / 5 / size, power = 10 ** Math.floor(Math.log10(most));
      const length = [5, 2, 1].map((each) => each * power).find((each) => each <= most * 1.0001);
      const right = width - 10, left = right - size * length, foot = height - 10;
      pen.strokeStyle = pen.fillStyle = style("--ink");
      pen.lineWidth = 2;
      pen.beginPath(); pen.moveTo(left, foot - 4); pen.lineTo(left, foot); pen.lineTo(right, foot); pen.lineTo(right, foot - 4); pen.stroke();
      pen.font = "12px system-ui, sans-serif";
      pen.textAlign = "right";
      pen.textBaseline = "bottom";
      pen.fillText(quantity(1e-6 * length, "m", 3), right, foot - 6);
    }

    function fillTables(state) {
      cells.shafts.forEach(([speed, load, direction], k) => {
        speed.textContent = speedOf(state, k);
        load.textContent = quantity(state.load[k], "N", 3);
        direction.textContent = (state.direction[k] * 180 / Math.PI).toFixed(0) + "°";
      });
      cells.meshes.forEach(([force, teeth], k) => {
        force.textContent = quantity(state.force[k], "N", 3);
        teeth.textContent = state.pairs[k] === 0 ? "do not touch" : state.force[k] > 0 ? "push" : "pull";
      });
    }

    return {
      plots: [
        { label: "Speeds of the shafts, over their ratio to " + data.shafts[data.judged], unit: "rad s-1", names: data.shafts },
        { label: "Forces of the meshes", unit: "N", names: data.meshes },
        { label: "Loads of the hubs", unit: "N", names: data.shafts },
      ],
      stateOf(numbers) {
        const part = (k) => numbers.subarray(k * shafts, (k + 1) * shafts);
        return { angle: part(0), speed: part(1), load: part(2), direction: part(3), force: numbers.subarray(4 * shafts, 4 * shafts + data.meshes.length), pairs: numbers.subarray(4 * shafts + data.meshes.length) };
      },
      draw(state, gears) {
        canvas.hidden = !state;
        if (state) { drawTrain(state, gears); fillTables(state); }
      },
      wordsOf: (state) => [data.shafts[data.judged] + " " + speedOf(state, data.judged),
        ...data.meshes.map((name, k) => name + " " + quantity(state.force[k], "N", 3))],
    };
  };
})();
