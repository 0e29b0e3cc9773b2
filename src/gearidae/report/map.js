// Map of the outcomes of a sweep: a field for each run in the colour and with the sign of its verdict, to choose runs by.
(() => {
  "use strict";
  const { element } = gearidae;

  // Black or white, whichever is read on a colour: by its luminance (WCAG 2, sRGB).
  function inkOn(colour) {
    const [red, green, blue] = [1, 3, 5].map((at) => {
      const share = parseInt(colour.slice(at, at + 2), 16) / 255;
      return share <= 0.04045 ? share / 12.92 : ((share + 0.055) / 1.055) ** 2.4;
    });
    return 0.2126 * red + 0.7152 * green + 0.0722 * blue > 0.18 ? "#000000" : "#ffffff";
  }

  gearidae.chip = (holder, look, words) => {
    const made = element("span", holder, look.sign + " " + (words || look.word), { className: "chip" });
    Object.assign(made.style, { background: look.colour, color: inkOn(look.colour) });
    return made;
  };

  // Number of a run by its places along the dimensions, the last one fastest, and back.
  gearidae.runAt = (data, places) => data.dims.reduce((number, dim, k) => number * dim.values.length + places[k], 0);
  gearidae.placesOf = (data, number) => {
    const places = [];
    for (const dim of [...data.dims].reverse()) {
      places.unshift(number % dim.values.length);
      number = Math.floor(number / dim.values.length);
    }
    return places;
  };

  gearidae.runWords = (data, number) =>
    gearidae.placesOf(data, number).map((place, k) => data.dims[k].name + " " + data.dims[k].values[place]).join(", ");

  // The longer one of the last two dimensions runs across, the other up; of more dimensions the map shows the part that a run lies in.
  gearidae.outcomeMap = (holder, data, choose) => {
    const box = element("div", holder, "", { className: "outcome-map" }), legend = element("p", box, "", { className: "key" });
    data.looks.forEach((look, k) => {
      gearidae.chip(legend, look);
      legend.append(" " + data.verdicts.filter((verdict) => verdict === k).length + " ");
    });
    const most = data.dims.length - 1, sizes = data.dims.map((dim) => dim.values.length);
    const [across, up] = most > 0 && sizes[most - 1] > sizes[most] ? [most - 1, most] : [most, most - 1];
    const columns = sizes[across], rows = up < 0 ? 1 : sizes[up];
    const grid = element("div", box, "", { className: "fields", role: "group" });
    grid.setAttribute("aria-label", "outcome of each run");
    grid.style.gridTemplateColumns = "repeat(" + columns + ", minmax(1.5rem, 3rem))";
    const span = (dim) => dim.name + ", " + dim.values[0] + " to " + dim.values[dim.values.length - 1];
    element("p", box, "Across: " + span(data.dims[across]) + (up < 0 ? "" : ". Up: " + span(data.dims[up])) + ".", { className: "hint" });
    const fields = [];
    let part = null;
    for (let row = rows - 1; row >= 0; row--) for (let column = 0; column < columns; column++) {
      const button = element("button", grid, "", { type: "button" });
      button.addEventListener("click", () => choose(numberAt(row, column)));
      button.addEventListener("keydown", (event) => {
        const step = { ArrowLeft: [0, -1], ArrowRight: [0, 1], ArrowUp: [1, 0], ArrowDown: [-1, 0] }[event.key];
        if (!step) return;
        event.preventDefault();
        const to = [Math.min(rows - 1, Math.max(0, row + step[0])), Math.min(columns - 1, Math.max(0, column + step[1]))];
        fields.find((field) => field.row === to[0] && field.column === to[1]).button.focus();
      });
      fields.push({ row, column, button });
    }
    const numberAt = (row, column) => gearidae.runAt(data, part.map((place, k) => (k === across ? column : k === up ? row : place)));

    // Shows the part with a run, and presses the fields of the chosen ones; marks has the colour of their lines.
    return (near, chosen, marks) => {
      part = gearidae.placesOf(data, near);
      for (const { row, column, button } of fields) {
        const number = numberAt(row, column), look = data.looks[data.verdicts[number]];
        button.textContent = look.sign;
        button.title = gearidae.runWords(data, number) + ": " + data.words[number];
        button.setAttribute("aria-label", button.title);
        button.setAttribute("aria-pressed", String(chosen.includes(number)));
        button.tabIndex = number === near ? 0 : -1;
        Object.assign(button.style, { background: look.colour, color: inkOn(look.colour) });
        button.style.borderBottomColor = (marks && marks(number)) || "";
      }
    };
  };
})();
