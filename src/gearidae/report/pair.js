// A pair of gears for the page of runs: the teeth near the pitch point with the force of all pairs, and both gears as a whole.
(() => {
  "use strict";
  const { style, colour, quantity, element, penOf } = gearidae;
  const { COAST, onLine, turned, wholeOf, drawNear, drawForce } = gearidae.mesh;

  // What explorer.js shows of the data of pairs; figureOf(words, name) makes a canvas in a figure.
  gearidae.explored = (data, figureOf) => {
    const mesh = figureOf("both gears near the pitch point", "near");
    element("figcaption", mesh.parentElement, "Teeth to scale, gaps between them × " + data.gaps + ". Arrow: force of all pairs on the gear; blue pushes, orange pulls.");
    const whole = figureOf("both gears as a whole", "whole");
    element("figcaption", whole.parentElement, "Whole gears; a dot marks one tooth of each.");

    // Pairs on the path of contact of a flank, by their places [m]: the coast flank mirrors the other, half a pitch later.
    function pairPlaces(gears, flank, travel) {
      const phase = flank === COAST ? 2 * gears.approach / gears.pitch + 0.5 - travel : travel, found = [];
      for (let place = gears.pitch * (phase - Math.floor(phase)); place <= gears.path; place += gears.pitch) found.push(place);
      return found;
    }

    function drawMesh(state, gears) {
      const flank = state.coast_gap < state.drive_gap ? COAST : 0;
      const motion = { travel: state.travel * gears.pitch, error: state.transmission_error, speed: state.gear_speed };
      const near = drawNear(mesh, gears, motion, flank);
      if (!near) return;
      const { pen, at } = near, push = flank === COAST ? -state.mesh_force : state.mesh_force; // positive pushes the teeth apart
      drawForce(near, gears, flank, gears.approach, push, data.largest);
      for (const place of pairPlaces(gears, flank, state.travel)) {
        pen.beginPath();
        pen.arc(...at(onLine(gears, flank, place)), 5, 0, 2 * Math.PI);
        pen.fillStyle = state.pairs_in_contact > 0 ? colour(push < 0 ? 1 : 0) : style("--ground");
        pen.strokeStyle = style("--ink");
        pen.lineWidth = 1.5;
        pen.fill();
        pen.stroke();
      }
    }

    // Both gears as a whole, the pinion to the left; a dot stands on tooth 0.
    function drawWhole(state, gears) {
      const sheet = penOf(whole);
      if (!sheet) return;
      const { pen, width, height } = sheet, wheels = [gears.pinion, gears.gear];
      wheels.forEach((wheel) => wholeOf(wheel));
      const long = wheels.reduce((sum, wheel) => sum + wheel.reach + Math.abs(wheel.centre), 1), tall = 2 * Math.max(...wheels.map((wheel) => wheel.reach)) + 1;
      const size = Math.min(width / long, height / tall);
      const pitchPoint = (width - size * long) / 2 + size * (gears.pinion.centre + gears.pinion.reach + 0.5);
      const angles = turned(gears, state.travel * gears.pitch, state.transmission_error, 0);
      wheels.forEach((wheel, k) => {
        pen.save();
        pen.translate(pitchPoint, height / 2);
        pen.scale(size, -size);
        pen.rotate(Math.PI / 2);
        pen.translate(0, wheel.centre);
        pen.rotate(wheel.turning * angles[k]);
        pen.fillStyle = style(k ? "--gear" : "--pinion");
        pen.strokeStyle = style("--ink");
        pen.lineWidth = 0.8 / size;
        pen.fill(wholeOf(wheel));
        pen.stroke(wholeOf(wheel));
        pen.fillStyle = style("--ink");
        pen.beginPath(); pen.arc(0, 0, 3 / size, 0, 2 * Math.PI); pen.fill();
        pen.beginPath(); pen.arc(0, -Math.sign(wheel.centre) * (wheel.reach - 4), Math.max(3 / size, 0.6), 0, 2 * Math.PI); pen.fill();
        pen.restore();
      });
    }

    return {
      plots: [["Speed of the gear", "rad s-1"], ["Torque of the tooth contacts on the gear", "N m"]].map(([label, unit]) => ({ label, unit, names: [""] })),
      stateOf: (numbers) => Object.fromEntries(data.columns.map((name, k) => [name, numbers[k]])),
      draw(state, gears) {
        for (const canvas of [mesh, whole]) canvas.hidden = !state;
        if (state) { drawMesh(state, gears); drawWhole(state, gears); }
      },
      wordsOf: (state) => ["gear " + state.gear_speed.toPrecision(4) + " rad/s", "torque of the contacts " + quantity(state.gear_contact_torque, "N m"),
        "force of all pairs " + quantity(state.mesh_force, "N"), "gap " + quantity(state.drive_gap, "m", 3) + " (drive), " + quantity(state.coast_gap, "m", 3) + " (coast)",
        state.pairs_in_contact + (state.pairs_in_contact === 1 ? " pair" : " pairs") + " in contact"],
    };
  };
})();
