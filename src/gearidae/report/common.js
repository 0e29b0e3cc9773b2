// What the scripts of a report share: reading embedded data, making elements, units, colours.
const gearidae = (() => {
  "use strict";
  // Okabe and Ito's palette; black has no contrast on a dark ground, so the theme's ink takes its place.
  const COLOURS = ["#0072B2", "#D55E00", "#009E73", "#CC79A7", "#E69F00", "#56B4E9", null];
  const ON_DARK = ["#4da6e0", "#f08040", "#2fc79b", "#e39ac2", "#f0b840", "#8fd0f5", null];
  const PREFIXES = { "-24": "y", "-21": "z", "-18": "a", "-15": "f", "-12": "p", "-9": "n", "-6": "µ", "-3": "m", "0": "", "3": "k", "6": "M", "9": "G" };

  function decode(text) {
    const raw = atob(text), view = new DataView(new ArrayBuffer(raw.length));
    for (let i = 0; i < raw.length; i++) view.setUint8(i, raw.charCodeAt(i));
    const values = new Float32Array(raw.length / 4);
    for (let i = 0; i < values.length; i++) values[i] = view.getFloat32(4 * i, true);
    return values;
  }

  function element(tag, parent, text, properties) {
    const made = document.createElement(tag);
    if (text) made.textContent = text;
    Object.assign(made, properties || {});
    parent.append(made);
    return made;
  }

  function prefixOf(largest) {
    if (!(largest > 0)) return { factor: 1, prefix: "" };
    const power = Math.min(9, Math.max(-24, 3 * Math.floor(Math.log10(largest * (1 + 1e-9)) / 3)));
    return { factor: 10 ** -power, prefix: PREFIXES[power] };
  }

  const style = (name) => getComputedStyle(document.documentElement).getPropertyValue(name).trim();
  const printing = window.matchMedia("print"), dark = window.matchMedia("(prefers-color-scheme: dark)");
  const isDark = () => dark.matches && !printing.matches;
  const colour = (run) => (isDark() ? ON_DARK : COLOURS)[run % 7] || style("--ink");

  function seconds(time) {
    if (time === 0) return "0 s";
    const scale = prefixOf(Math.abs(time));
    return (time * scale.factor).toPrecision(6) + " " + scale.prefix + "s";
  }

  function quantity(value, unit, digits) {
    const scale = prefixOf(Math.abs(value));
    return Number((value * scale.factor).toPrecision(digits || 4)) + " " + scale.prefix + unit;
  }

  // Round numbers between two, some of the wanted number of them.
  function ticks(low, high, wanted) {
    const rough = (high - low) / Math.max(wanted, 1), power = 10 ** Math.floor(Math.log10(rough));
    const step = [1, 2, 5, 10].find((each) => each * power >= rough * 0.999) * power;
    const found = [];
    for (let i = Math.ceil(low / step - 1e-9); i * step <= high + 1e-9 * step; i++) found.push(i * step);
    return { found, digits: Math.max(0, Math.min(12, -Math.floor(Math.log10(step) + 1e-9))) };
  }

  function readable(prefix, unit) {
    return unit === "rad s-1" ? (prefix ? prefix + "rad/s" : "rad/s") : prefix + unit.replace("m s-1", "m/s");
  }

  // Draws in the next frame, once however often it is asked for.
  function soon(draw) {
    let waiting = false;
    return () => {
      if (waiting) return;
      waiting = true;
      requestAnimationFrame(() => { waiting = false; draw(); });
    };
  }

  // Draws anew whenever the size, the colours or the medium change.
  function whenSeenAnew(draw, later) {
    window.addEventListener("resize", later);
    for (const query of [dark, printing]) query.addEventListener("change", draw);
    window.addEventListener("beforeprint", draw);
    window.addEventListener("afterprint", draw);
  }

  // A canvas cleared and scaled so that one unit is one CSS pixel; null while it is not shown.
  function penOf(canvas) {
    const ratio = window.devicePixelRatio || 1, width = canvas.clientWidth, height = canvas.clientHeight;
    if (!width) return null;
    if (canvas.width !== Math.round(width * ratio) || canvas.height !== Math.round(height * ratio)) {
      canvas.width = Math.round(width * ratio);
      canvas.height = Math.round(height * ratio);
    }
    const pen = canvas.getContext("2d");
    pen.setTransform(ratio, 0, 0, ratio, 0, 0);
    pen.clearRect(0, 0, width, height);
    return { pen, width, height };
  }

  // Values from the lowest to the highest, with room at both ends.
  function withMargin([low, high]) {
    const margin = 0.05 * (high - low) || 0.05 * Math.abs(high) || 1;
    return [low - margin, high + margin];
  }

  // Grid of a plot, with margins left, right, top and bottom: times across, and the place of a time in pixels.
  function timesAcross(pen, { left, right, top, bottom, width, height }, [from, to]) {
    const inner = width - left - right, foot = height - bottom, x = (time) => left + inner * (time - from) / (to - from);
    const scale = prefixOf(Math.max(Math.abs(from), Math.abs(to)));
    const across = ticks(from * scale.factor, to * scale.factor, inner / 90);
    pen.font = "12px system-ui, sans-serif";
    pen.fillStyle = style("--faint");
    pen.strokeStyle = style("--line");
    pen.lineWidth = 1;
    pen.textAlign = "center";
    pen.textBaseline = "top";
    for (const tick of across.found) {
      const at = x(tick / scale.factor);
      pen.beginPath(); pen.moveTo(at, top); pen.lineTo(at, foot); pen.stroke();
      if (at < left + inner - 24) pen.fillText(tick.toFixed(across.digits), at, foot + 6);
    }
    pen.textAlign = "right";
    pen.fillText(scale.prefix + "s", width - right, foot + 6);
    return x;
  }

  // The same of values, after the times: so many of their unit to one in SI, ticks some pixels apart.
  function valuesUp(pen, { left, right, top, bottom, width, height }, [low, high], factor, apart) {
    const tall = height - top - bottom, y = (value) => top + tall * (high - value) / (high - low);
    const up = ticks(low * factor, high * factor, tall / apart);
    pen.textBaseline = "middle";
    for (const tick of up.found) {
      const at = y(tick / factor);
      pen.beginPath(); pen.moveTo(left, at); pen.lineTo(width - right, at); pen.stroke();
      pen.fillText(tick.toFixed(up.digits), left - 6, at);
    }
    return y;
  }

  // Name of a line of a plot behind a patch of its colour, which follows the colours of the page.
  function keyOf(parent, words, run) {
    const key = element("span", parent, "", { className: "key-of" }), patch = element("span", key, "", { className: "patch" });
    const paint = () => { patch.style.background = colour(run); };
    key.append(words);
    paint();
    dark.addEventListener("change", paint);
    return key;
  }

  const slug = (text) => text.toLowerCase().replace(/[^a-z0-9]+/g, "_").replace(/^_+|_+$/g, "") || "report";

  return {
    slug, decode, element, prefixOf, readable, style, colour, seconds, quantity, soon, whenSeenAnew, penOf, withMargin, timesAcross,
    valuesUp, keyOf,
  };
})();
