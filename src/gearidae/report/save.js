// Downloads: pictures as SVG and PNG, series as CSV. Made in the page, nothing is asked of any server.
(() => {
  "use strict";
  const { element, slug, style } = gearidae;
  const SCALE = 2; // pixels of a PNG for each CSS pixel

  gearidae.save = (blob, ending, name) => {
    const link = element("a", document.body, "", {
      href: URL.createObjectURL(blob), download: slug(document.querySelector("h1").textContent + " " + name) + "." + ending,
    });
    link.click();
    link.remove();
    setTimeout(() => URL.revokeObjectURL(link.href), 10000);
  };

  // A drawing in the colours of the light scheme, on white, which stands alone in a file.
  function standalone(svg) {
    const copy = svg.cloneNode(true), box = svg.viewBox.baseVal;
    copy.setAttribute("xmlns", "http://www.w3.org/2000/svg");
    copy.setAttribute("fill", "#000000");
    copy.setAttribute("stroke-linejoin", "round");
    const ground = document.createElementNS("http://www.w3.org/2000/svg", "rect");
    for (const [name, value] of [["x", box.x], ["y", box.y], ["width", box.width], ["height", box.height], ["fill", "#ffffff"]]) {
      ground.setAttribute(name, value);
    }
    copy.prepend(ground);
    return new XMLSerializer().serializeToString(copy).replace(/var\(--c-([0-9a-f]{6})\)/g, "#$1");
  }

  function savePicture(svg, name) {
    const box = svg.viewBox.baseVal, image = new Image(), canvas = document.createElement("canvas");
    canvas.width = SCALE * 4 / 3 * box.width; // points to pixels
    canvas.height = SCALE * 4 / 3 * box.height;
    image.onload = () => {
      canvas.getContext("2d").drawImage(image, 0, 0, canvas.width, canvas.height);
      canvas.toBlob((blob) => gearidae.save(blob, "png", name));
    };
    image.src = "data:image/svg+xml;charset=utf-8," + encodeURIComponent(standalone(svg));
  }

  // Panels over the time in view as a CSV table, in SI units.
  gearidae.tableOf = (data, panels, runs, indices) => {
    const quoted = (text) => '"' + text.replaceAll('"', '""') + '"';
    const columns = [], names = ["time [s]"];
    for (const panel of panels) {
      for (const run of runs) {
        columns.push(panel.valuesOf(run));
        const unit = panel.unit ? " [" + panel.unit + "]" : "", label = data.runs.length > 1 ? " " + data.runs[run].label : "";
        names.push(panel.name + unit + label);
      }
    }
    const lines = [];
    if (data.reduced > 1) lines.push("# of every " + data.reduced + " samples the smallest and the largest");
    lines.push(names.map(quoted).join(","));
    const count = Math.max(0, ...columns.map((values) => values.length));
    const [first, last] = indices({ length: count });
    for (let i = first; i <= last; i++) {
      const numbers = columns.map((values) => (Number.isNaN(values[i]) ? "" : values[i].toPrecision(8)));
      lines.push([(data.end * i / (count - 1 || 1)).toPrecision(9), ...numbers].join(","));
    }
    return new Blob([lines.join("\n") + "\n"], { type: "text/csv" });
  };

  // A canvas with its title above, on the page's ground.
  gearidae.savePlot = (canvas, title, left, name) => {
    const ratio = canvas.width / canvas.clientWidth, head = 22 * ratio;
    const copy = document.createElement("canvas"), pen = copy.getContext("2d");
    copy.width = canvas.width;
    copy.height = canvas.height + head;
    pen.fillStyle = style("--ground");
    pen.fillRect(0, 0, copy.width, copy.height);
    pen.drawImage(canvas, 0, head);
    pen.fillStyle = style("--ink");
    pen.font = 13 * ratio + "px system-ui, sans-serif";
    pen.fillText(title, left * ratio, 15 * ratio);
    copy.toBlob((blob) => gearidae.save(blob, "png", name));
  };

  gearidae.saveButtons = (holder, actions) => {
    const box = element("span", holder, "", { className: "save" });
    for (const [ending, title, action] of actions) {
      const button = element("button", box, ending, { type: "button", title });
      button.setAttribute("aria-label", title);
      button.addEventListener("click", action);
    }
  };

  for (const figure of document.querySelectorAll("figure.picture")) {
    const svg = figure.querySelector("svg"), name = figure.dataset.name;
    gearidae.saveButtons(figure.querySelector("figcaption"), [
      ["SVG", "download this picture as SVG", () => gearidae.save(new Blob([standalone(svg)], { type: "image/svg+xml" }), "svg", name)],
      ["PNG", "download this picture as PNG", () => savePicture(svg, name)],
    ]);
  }
})();
