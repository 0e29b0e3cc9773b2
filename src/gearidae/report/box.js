// Box zoom: a rectangle drawn with the pointer over a panel.
(() => {
  "use strict";
  const { element } = gearidae;
  const FLAT = 12; // a box less high than these pixels is about time alone

  // Calls done(from, to, down) with its ends across, and those down the canvas or null, in its pixels.
  gearidae.boxZoom = (canvas, wanted, done) => {
    let start = null, frame = null;
    const within = (value, most) => Math.min(most, Math.max(0, value));
    const place = (event) => {
      const box = canvas.getBoundingClientRect();
      return { x: within(event.clientX - box.left, box.width), y: within(event.clientY - box.top, box.height) };
    };
    const stop = () => { start = null; if (frame) frame.remove(); frame = null; };
    const show = (end) => {
      const flat = Math.abs(end.y - start.y) < FLAT;
      Object.assign(frame.style, {
        left: canvas.offsetLeft + Math.min(start.x, end.x) + "px", width: Math.abs(end.x - start.x) + "px",
        top: canvas.offsetTop + (flat ? 0 : Math.min(start.y, end.y)) + "px",
        height: (flat ? canvas.clientHeight : Math.abs(end.y - start.y)) + "px",
      });
    };
    canvas.addEventListener("pointerdown", (event) => {
      if (!wanted(event)) return;
      event.stopImmediatePropagation();
      event.preventDefault();
      canvas.focus();
      try { canvas.setPointerCapture(event.pointerId); } catch { /* a pointer that has gone */ }
      stop();
      start = place(event);
      frame = element("div", canvas.parentElement, "", { className: "box" });
      show(start);
    });
    canvas.addEventListener("pointermove", (event) => {
      if (!start) return;
      event.stopImmediatePropagation();
      show(place(event));
    });
    canvas.addEventListener("pointerup", (event) => {
      if (!start) return;
      const end = place(event), begin = start;
      stop();
      if (Math.abs(end.x - begin.x) < 4) return; // a click
      const across = [begin.x, end.x].sort((a, b) => a - b), down = [begin.y, end.y].sort((a, b) => a - b);
      done(across[0], across[1], down[1] - down[0] < FLAT ? null : down);
    });
    canvas.addEventListener("pointercancel", stop);
    canvas.addEventListener("keydown", (event) => { if (event.key === "Escape") stop(); });
  };
})();
