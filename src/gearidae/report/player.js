// Pictures in a row to go through: Play and Pause, single steps, a slider over time.
(() => {
  "use strict";
  const { element } = gearidae;
  const PLAYED = 14; // seconds for all that is played
  const still = window.matchMedia("(prefers-reduced-motion: reduce)");

  // Calls go(number); now() is the number of the picture shown, range() gives the first and last one that are played, once through.
  gearidae.player = (holder, label, now, range, go) => {
    const controls = element("div", holder, "", { className: "controls" });
    let playing = null;

    function stop() {
      if (playing !== null) cancelAnimationFrame(playing);
      playing = null;
      button.textContent = "Play";
    }

    function play() {
      if (playing !== null) { stop(); return; }
      const [from, to] = range(), start = now() > from && now() < to ? now() : from;
      const perSecond = Math.max((to - from) / PLAYED, 1);
      let began = null;
      button.textContent = "Pause";
      const step = (time) => {
        if (began === null) began = time;
        const number = Math.floor(start + perSecond * (time - began) / 1000);
        if (number !== now()) go(Math.min(number, to));
        if (number >= to) stop(); else playing = requestAnimationFrame(step);
      };
      playing = requestAnimationFrame(step);
    }

    const button = element("button", controls, "Play", { type: "button" });
    if (still.matches) button.title = "moves the picture";
    button.addEventListener("click", play);
    for (const [sign, name, step] of [["−1", "one picture back", -1], ["+1", "one picture on", 1]]) {
      const single = element("button", controls, sign, { type: "button", title: name });
      single.setAttribute("aria-label", name);
      single.addEventListener("click", () => { stop(); go(now() + step); });
    }
    const slider = element("input", controls, "", { type: "range", min: 0, step: 1, value: 0 });
    slider.setAttribute("aria-label", label);
    slider.addEventListener("input", () => { stop(); go(Number(slider.value)); });
    return { controls, slider, stop };
  };
})();
