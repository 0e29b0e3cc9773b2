"""Faults that the tests must catch: one small change of the physics each, and the tests that should fail of it."""

from dataclasses import dataclass

__all__ = ["MUTANTS", "SHORT", "Mutant"]


@dataclass(frozen=True)
class Mutant:
    """A wrong version of one line.

    Attributes
    ----------
    what : str
        The fault in words.
    file : str
        In ``src/gearidae``.
    old, new : str
        The text, which occurs once, and what it becomes.
    tests : tuple of str
        Files (or single tests) in ``tests`` of which at least one test must fail.
    """

    what: str
    file: str
    old: str
    new: str
    tests: tuple[str, ...]


JKR, TIP = ("asperities/test_jkr.py",), ("asperities/test_tip.py",)
HISTORY, LAW = ("contact/test_history.py",), ("contact/test_law.py",)
IMPACT = ("engine/test_closed_forms.py::test_an_impact_loses_the_adhesion_energy",)
SHAFTS = ("properties/test_gears_without_adhesion.py",)
MESH = ("properties/test_mesh.py",)

SHORT = (
    Mutant(
        "pull-off load with DMT's factor 2 in place of 1.5",
        "asperities/tip.py",
        "pull_off = 1.5 * math.pi",
        "pull_off = 2.0 * math.pi",
        TIP,
    ),
    Mutant(
        "play operator clipped at 90 % of the stretch limit",
        "contact/history.py",
        "max(joined, gap - limit)",
        "max(joined, gap - 0.9 * limit)",
        ("properties/test_force_law.py::test_nothing_stretches_beyond_the_limit",),
    ),
    Mutant(
        "module, and with it the length of the path of contact, too large",
        "mesh/involute.py",
        "module = 2 * base_radius / (",
        "module = 2.02 * base_radius / (",
        ("mesh/test_involute.py",),
    ),
)
"""Caught without compiling anything."""

MUTANTS = (
    *SHORT,
    Mutant(
        "wrong constant in the displacement of an asperity (12^(1/3))",
        "asperities/jkr.py",
        "return np.asarray(t * (t**3 - 4.0) / 3.0)",
        "return np.asarray(t * (t**3 - 4.0) / 2.9)",
        JKR,
    ),
    Mutant(
        "wrong constant in the measure of an asperity's quadrature (12^(1/3))",
        "asperities/jkr.py",
        "rate = 4.0 * 12.0 ** (1 / 3) * s**3",
        "rate = 4.0 * 12.0 ** (1 / 3.01) * s**3",
        JKR,
    ),
    Mutant(
        "fold at another radius (a^3 = 1/18)",
        "asperities/jkr.py",
        "S_FOLD = (1.0 / 18.0)",
        "S_FOLD = (1.0 / 18.1)",
        JKR,
    ),
    Mutant(
        "work of adhesion of one surface in place of two",
        "asperities/tip.py",
        "adhesion = 2.0 * surface.energy",
        "adhesion = surface.energy",
        TIP,
    ),
    Mutant(
        "modulus of one body in place of two",
        "asperities/tip.py",
        "youngs_modulus / (2.0 * (1.0",
        "youngs_modulus / (1.0 * (1.0",
        TIP,
    ),
    Mutant(
        "asperities that keep their stretch when compressed further",
        "contact/history.py",
        "return min(max(joined, gap - limit), gap)",
        "return max(joined, gap - limit)",
        HISTORY,
    ),
    Mutant(
        "turning point within a step at a wrong place",
        "formulas/interpolation.py",
        "(0.5 * b + s * a / 3.0)",
        "(0.5 * b + s * a / 2.0)",
        ("properties/test_force_law.py::test_the_turning_point_of_a_cubic_is_exact",),
    ),
    Mutant(
        "force scale with a wrong power of the roughness",
        "contact/kernels/law.py",
        "hertz_factor * roughness**1.5",
        "hertz_factor * roughness**1.51",
        LAW,
    ),
    Mutant(
        "history not updated at a turning point",
        "engine/events/pair_events.py",
        "joined_height(h.joined[material], middle, limit))",
        "h.joined[material])",
        (*IMPACT, "engine/test_twin.py"),
    ),
    Mutant(
        "history not followed through a turning point within a step",
        "engine/laws/statistical.py",
        "turned = h.direction * rate < 0.0",
        "turned = False",
        MESH,
    ),
    Mutant(
        "SAM fraction taken for the bare one",
        "engine/setup/build_contact.py",
        "enumerate(parts_of(scene))",
        "enumerate([one._replace(share=1.0 - one.share) for one in parts_of(scene)])",
        IMPACT,
    ),
    Mutant(
        "tip relief that does no work on the gear",
        "engine/pairs/pair_force.py",
        "relief += sign * f.load * slope",
        "relief += 0.0 * slope",
        SHAFTS,
    ),
    Mutant(
        "slope of the tip relief doubled",
        "engine/pairs/tooth_pairs.py",
        "gap += 0.5 * s.relief_curvature",
        "gap += 1.0 * s.relief_curvature",
        MESH,
    ),
    Mutant(
        "coast flank that pushes like the drive flank",
        "engine/pairs/pair_force.py",
        "1.0 - 2.0 * pair.flank",
        "1.0 + 0.0 * pair.flank",
        MESH,
    ),
    Mutant(
        "coast flank half a pitch out of place",
        "engine/setup/build.py",
        "2.0 * geometry.approach / pitch + 0.5",
        "2.0 * geometry.approach / pitch",
        ("properties/test_engine_edges.py",),
    ),
    Mutant(
        "radius of curvature of the wrong sign",
        "engine/pairs/tooth_pairs.py",
        "pinion - pinion * pinion * sum_curvature",
        "pinion + pinion * pinion * sum_curvature",
        SHAFTS,
    ),
    Mutant(
        "inertias of pinion and gear swapped",
        "engine/setup/build.py",
        "= mass / pinion_mass, mass / gear_mass",
        "= mass / gear_mass, mass / pinion_mass",
        ("engine/test_closed_forms.py",),
    ),
    Mutant(
        "drag proportional to the speed",
        "laws/shaft/drag.py",
        "value -= m.scene.torque[shaft].drag * speed * abs(speed)",
        "value -= m.scene.torque[shaft].drag * speed",
        ("engine/test_closed_forms.py",),
    ),
    Mutant(
        "mesh damping left out",
        "engine/motion/shafts.py",
        "force = mesh_force(m, y[V], mesh.force)",
        "force = mesh.force",
        SHAFTS,
    ),
    Mutant(
        "curvature of the static error left out",
        "engine/motion/residual.py",
        "s.error.pinion_curvature * s.surface_speed * s.surface_speed",
        "0.0 * s.surface_speed",
        SHAFTS,
    ),
    Mutant(
        "phase of a harmonic torque left out",
        "laws/shaft/harmonic.py",
        "* math.cos(m.tables[k + 1] * x + m.tables[k + 2])\n        k += 3\n    return value\n",
        "* math.cos(m.tables[k + 1] * x)\n        k += 3\n    return value\n",
        SHAFTS,
    ),
    Mutant(
        "dry resistance that pushes a gear that turns backwards",
        "engine/motion/shafts.py",
        "return m.state.slip * own_limit(m, LOAD, t, y, y[W])",
        "return own_limit(m, LOAD, t, y, y[W])",
        ("properties/test_engine_symmetries.py",),
    ),
    Mutant(
        "dry resistance that holds twice as much as it should",
        "laws/shaft/dry_load.py",
        "return value + max(driving_force(m, shaft, t, angle, speed), 0.0)",
        "return value + 2.0 * max(driving_force(m, shaft, t, angle, speed), 0.0)",
        ("properties/test_event_times.py",),
    ),
    Mutant(
        "Adams formulas with too short lengths of the steps before the last",
        "engine/adams.py",
        "a.time_lags[i] = a.time_lags[i - 1] + step",
        "a.time_lags[i] = a.time_lags[i - 1] + 0.99 * step",
        ("engine/test_adams.py",),
    ),
    Mutant(
        "states between the steps from a formula of one order less",
        "engine/adams.py",
        "count = a.order_used + 1",
        "count = a.order_used",
        ("engine/test_adams.py",),
    ),
    Mutant(
        "step size chosen for one order more than the step uses",
        "engine/integrate/step_control.py",
        "return float(twice ** (1.0 / (order + 1.0)))",
        "return float(twice ** (1.0 / (order + 2.0)))",
        ("engine/test_step_control.py",),
    ),
    Mutant(
        "a small vibration integrated by formulas that amplify it",
        "engine/integrate/step_control.py",
        "return min(a.next_order, MAX_DAMPED_ORDER)",
        "return min(a.next_order, 7)",
        ("engine/test_adams.py", "engine/test_step_control.py"),
    ),
    Mutant(
        "a mesh mark that rounding may put ahead of the phase that has crossed it",
        "engine/events/mesh_marks.py",
        "max(low, min(here, crossed))",
        "max(low, here)",
        ("engine/test_marks.py",),
    ),
    Mutant(
        "a step that may be longer than a pair takes to part",
        "engine/events/events.py",
        " or outruns_relief(m, y, steps)",
        "",
        ("engine/test_parting_between_steps.py",),
    ),
    Mutant(
        "work of a stiff drive on errors of the speed left out of the balance's bound",
        "engine/observers/balance.py",
        "_torque_slopes(m, t, y) * top_speed * t",
        "0.0",
        ("engine/test_balance_bound.py",),
    ),
    Mutant(
        "an energy balance out of its bound that nothing is said of",
        "archive/totals.py",
        "if not out_by > 1.0:",
        "if not out_by > 1e9:",
        ("runs/test_imbalance.py",),
    ),
    Mutant(
        "slopes of the gear's acceleration without the tip relief",
        "engine/motion/shafts.py",
        "gear_u = f.gear_u + mesh.force_u + mesh.relief_u",
        "gear_u = f.gear_u + mesh.force_u",
        MESH,
    ),
    Mutant(
        "Newton correction without the slope of the force on the gear",
        "engine/integrate/correction.py",
        "w_v, w_w = -s.gear_v - s.gear_u * step,",
        "w_v, w_w = -s.gear_v,",
        ("engine/test_correction.py",),
    ),
    Mutant(
        "deflection of the bodies with the wrong sign",
        "engine/elastic/nodes.py",
        "deviation[i] -= kappa[order, k, i] * p",
        "deviation[i] += kappa[order, k, i] * p",
        ("engine/test_elastic.py",),
    ),
    Mutant(
        "slope of an elastic contact's force as if the bodies did not follow",
        "engine/elastic/static_condensation.py",
        "slope += length * sums[i] * follow[i]",
        "slope += 0.0 * sums[i] * follow[i]",
        ("engine/test_static_condensation.py",),
    ),
    Mutant(
        "a joining loss recorded at the turning point, and taken from the radius's power at the next look",
        "engine/observers/adhesion_loss.py",
        "            _accumulate_before(m, flank, pair, y[PHASE], losses)",
        "            pass",
        ("engine/test_energy_balance.py",),
    ),
    Mutant(
        "drag's loss without the square of the speed's deviation",
        "formulas/quadrature.py",
        "(3.0 * mean + b) * b * b",
        "b * b * b",
        ("engine/test_energy_balance.py",),
    ),
    Mutant(
        "a speed in the middle of a step for which the rates count half",
        "formulas/quadrature.py",
        "0.5 * h * rates",
        "0.25 * h * rates",
        ("engine/test_energy_balance.py::test_drag_knows_the_mean_speed",),
    ),
    Mutant(
        "a root accepted at a distance a hundred times too large",
        "engine/integrate/roots.py",
        "(b - a) * high < tolerance * (high - low)",
        "(b - a) * high < 100.0 * tolerance * (high - low)",
        ("engine/test_search.py",),
    ),
    Mutant(
        "deflections settled at the end of a step, and not noted for the next ones",
        "engine/elastic/static_condensation.py",
        "elif kind == PREDICT:",
        "elif kind == FINISH:",
        ("engine/test_static_condensation.py",),
    ),
    Mutant(
        "curvature of a measured surface averaged as if it had one direction",
        "surfaces/statistics.py",
        "m4 = 0.375 * float(",
        "m4 = 0.5 * float(",
        ("surfaces/test_measured.py",),
    ),
    Mutant(
        "summits of a measured surface left at the points of the grid",
        "surfaces/summits.py",
        ".astype(np.float64) + _to_the_top(field, rows, columns)",
        ".astype(np.float64)",
        ("surfaces/test_measured.py",),
    ),
    Mutant(
        "what was filled in the holes of a measured surface counted as measured",
        "surfaces/statistics.py",
        "            inside &= far[np.ix_(*indices)]",
        "            pass",
        ("surfaces/test_measured.py",),
    ),
    Mutant(
        "a row with more cells than there are headings taken for one without the last",
        "scene/text_table.py",
        "                    if len(cells) == width + 1 and (self.remarked or not cells[-1]):",
        "                    if len(cells) == width + 1:",
        ("scene/test_text_table.py",),
    ),
    Mutant(
        "a record cut at its first missing sample",
        "analysis/signal.py",
        "    end = len(values) - int(present[::-1].argmax()) if present.any() else 0",
        "    end = len(values) if present.all() else int(present.argmin())",
        ("analysis/test_ringing.py",),
    ),
    Mutant(
        "impacts that are no pitch apart taken for those of a speed without error",
        "analysis/impacts.py",
        "    return spacing if evident else 1.0",
        "    return 1.0",
        ("monitor/test_bad_records.py",),
    ),
    Mutant(
        "bands of a spectrum that add up their lines in place of the mean",
        "analysis/spectra.py",
        "means = np.add.reduceat(density[crowded], first) / count",
        "means = np.add.reduceat(density[crowded], first)",
        ("plot/test_spectra_and_maps.py",),
    ),
    Mutant(
        "influence coefficients of elastic nodes as the grid has them, not symmetric",
        "engine/elastic/layout.py",
        "0.5 * (work + work.T) / weights",
        "work / weights",
        ("engine/test_elastic.py::test_the_force_has_a_potential",),
    ),
    Mutant(
        "pressure not noted where a contact passes from one place to the next",
        "engine/observers/exposures/contacts.py",
        "        if pressing > 0.0:\n",
        "        if pressing > 1e300:\n",
        ("engine/test_exposures.py::test_sliding_work_and_pressure_are_those_of_the_samples",),
    ),
    Mutant(
        "a contact that comes and turns between two looks at the exposures not counted",
        "engine/observers/exposures/accumulation.py",
        "    if exposure.known == 0 or exposure.pair != pair or exposure.time < before:\n",
        "    if exposure.pair != pair:\n",
        ("engine/test_exposures.py::test_contacts_count_that_come_and_turn_between_two_looks",),
    ),
    Mutant(
        "sliding work not ended at a separation",
        "engine/observers/exposures/accumulation.py",
        "        _touch(m, t, y, yp, flank, pair, k)\n",
        "        pass\n",
        ("engine/test_exposures.py::test_sliding_work_of_short_contacts",),
    ),
    Mutant(
        "what a contact has joined not shortened by the lag of its length",
        "engine/observers/exposures/contacts.py",
        "    return h.adhesion_lag / lost if lost > 0.0 else 0.0\n",
        "    return 0.0\n",
        ("engine/test_exposures.py::test_adhesion_work_adds_up_to_the_loss",),
    ),
    Mutant(
        "what a contact has joined lost at the end of a run",
        "engine/step.py",
        "    if done or error != 0:\n",
        "    if error != 0:\n",
        ("engine/test_exposures.py::test_nothing_is_lost_where_a_run_ends",),
    ),
    Mutant(
        "error estimate of sliding work without effect",
        "engine/observers/exposures/sliding.py",
        "    if error > 0.0:",
        "    if error > 1e300:",
        ("engine/test_exposures.py::test_sums_at_a_usual_tolerance_are_those_at_a_tight_one",),
    ),
    Mutant(
        "sliding work of a contact that pulls while the sliding speed turns",
        "engine/observers/exposures/sliding.py",
        "    if pushes or (not turns and _rises(",
        "    if pushes or (_rises(",
        ("engine/test_sliding.py",),
    ),
    Mutant(
        "deep contacts of elastic bodies not counted before a run returns to the asperity model",
        "engine/events/histories.py",
        "            m.state.deep_exits = m.state.extremes.mesh_exits",
        "            m.state.deep_exits = 0",
        ("engine/test_returning.py",),
    ),
    Mutant(
        "stretch of asperities not kept where a run returns to the asperity model",
        "engine/changeover.py",
        "            h.joined -= state[",
        "            h.joined -= 0.0 * state[",
        ("engine/test_returning.py",),
    ),
    Mutant(
        "weights at the places of a panel with the mean counted twice",
        "contact/kernels/knots.py",
        "terms[:, 0] *= 0.5",
        "terms[:, 0] *= 1.0",
        ("contact/test_knots.py",),
    ),
    Mutant(
        "Ctrl-C while a scene is written left as an error of pydantic",
        "scene/group.py",
        "raise (error.__cause__ or error) from None",
        "raise",
        ("scene/test_bad_input.py::test_an_interrupt_stays_one",),
    ),
    Mutant(
        "force of rolling asperities without the changing radius",
        "engine/population/contact_point.py",
        "first = share * at.arc_rate + 0.5 * share * share * at.radius_rate",
        "first = share * at.arc_rate",
        (
            "engine/test_population.py::test_forces_are_derivatives_of_the_energy_and_slopes_those_of_the_forces",
        ),
    ),
    Mutant(
        "dips of asperities between two steps not looked for",
        "engine/events/asperity_events.py",
        "return first if first < 1.0 else -1.0",
        "return -1.0",
        ("engine/test_population.py::test_an_asperity_that_is_grazed_between_two_steps_is_not_missed",),
    ),
    Mutant(
        "energy that an asperity loses by letting go booked as that by joining",
        "engine/events/asperity_events.py",
        "        m.state.energy.adhesion_loss += energy\n",
        "        m.state.energy.adhesion_loss -= energy\n",
        ("engine/test_population.py::test_a_roller_meets_three_asperities",),
    ),
    Mutant(
        "asperities let go a thousandth before their fold",
        "engine/setup/build_population.py",
        "RELEASED: Final = 1e-10",
        "RELEASED: Final = 1e-3",
        ("engine/test_population.py::test_a_roller_meets_three_asperities",),
    ),
    Mutant(
        "joined asperities of a checkpoint taken though no pair has them",
        "engine/setup/kept_asperities.py",
        "require(take_joined(m, y, joined) == joined.size,",
        "require(take_joined(m, y, joined) >= 0,",
        ("engine/test_population.py::test_joined_asperities_that_no_run_has_left_are_refused",),
    ),
    Mutant(
        "flanks of a population drawn with tooth and flank exchanged",
        "populations/flanks.py",
        "rng = np.random.default_rng(which)",
        "rng = np.random.default_rng(which[::-1])",
        ("populations/test_flanks.py::test_the_preset_s_surface_is_the_one_that_a_prototype_drew",),
    ),
    Mutant(
        "energy of an asperity counted from detachment in place of free surfaces",
        "contact/kernels/single.py",
        "energy = (law.detachment_energy + law.energy(displacement))",
        "energy = law.energy(displacement)",
        ("contact/test_single.py::test_tables_have_the_load_and_the_energy_of_the_law",),
    ),
    Mutant(
        "friction of the flanks drives the pinion",
        "engine/friction/forces.py",
        "pinion -= friction * first",
        "pinion += friction * first",
        ("engine/test_friction.py::test_the_balance_closes_with_friction",),
    ),
    Mutant(
        "what holds gears at rest counted for the last element alone",
        "engine/friction/rest.py",
        "held += other.limit * abs(x * other.pinion + y * other.gear)",
        "held = other.limit * abs(x * other.pinion + y * other.gear)",
        ("engine/test_friction.py::test_gears_stay_at_rest_inside_the_zonotope_and_move_outside",),
    ),
    Mutant(
        "sliding of the flanks with levers that do not change along the path",
        "engine/friction/pairs.py",
        "rate = w * (m.scene.friction.pinion_lever_slope * surface_speed + m.scene.friction.gear_lever_slope * w)",
        "rate = 0.0 * w * surface_speed",
        ("engine/test_friction.py::test_the_balance_closes_with_friction",),
    ),
    Mutant(
        "shares of the pairs in the loss to friction equal in place of those of the mean law",
        "mesh/friction.py",
        "share = (positions < length) * (1.0 if equal_shares else np.sqrt(reduced))",
        "share = (positions < length) * np.ones_like(reduced)",
        ("mesh/test_friction.py::test_numbers_of_the_preset",),
    ),
    Mutant(
        "coefficients of two materials weighted by their shares in place of their forces",
        "runs/rubbing.py",
        "counted = contact.part_areas(gap) if shear else contact.part_forces(gap)",
        "counted = [load * part.share for part in contact.parts]",
        (
            "studies/test_estimates.py::test_coefficients_of_two_materials_count_with_the_forces_that_they_carry",
        ),
    ),
    Mutant(
        "one pair that rolls counted as rest",
        "archive/run_summary.py",
        "if self._gear or len(self._flanks) > 1:",
        "if self._gear or self._flanks:",
        ("archive/test_run_summary.py::test_what_friction_takes_and_holds",),
    ),
    Mutant(
        "energy of the attraction across the gap too small by a half",
        "engine/laws/attraction.py",
        "energy = -2.0 / 3.0 * pull * near",
        "energy = -1.0 / 3.0 * pull * near",
        ("engine/test_attraction.py::test_gears_apart_are_pulled_by_both_flanks_and_along_the_path",),
    ),
    Mutant(
        "attraction along the path of contact with the other sign",
        "engine/laws/attraction.py",
        "-path, -by_gap, -by_position",
        "path, -by_gap, -by_position",
        ("engine/test_attraction.py::test_gears_apart_are_pulled_by_both_flanks_and_along_the_path",),
    ),
    Mutant(
        "drawn asperities that let go where they touch",
        "studies/drawn_contact.py",
        "held = joined & (last >= end)",
        "held = joined & (last > end)",
        ("studies/test_pull_off.py::test_one_asperity_has_the_pull_off_of_its_law",),
    ),
    Mutant(
        "hub of the pinion that does not know the force of its pin",
        "engine/friction/hubs.py",
        "pinion = math.hypot(along - pin[0], over - pin[1])\n    if",
        "pinion = math.hypot(along, over)\n    if",
        ("engine/test_joints.py",),
    ),
    Mutant(
        "loads of hubs that are solved where no load is a solution",
        "engine/friction/hubs.py",
        "room = -half - math.sqrt(square * whole)",
        "room = half - math.sqrt(square * whole)",
        ("engine/test_hub_load.py::test_loads_solve_their_equation",),
    ),
    Mutant(
        "friction of the coast flank left out of the loads of the hubs",
        "engine/friction/hubs.py",
        "return along, mesh.drive_friction - friction.cosine * mesh.coast_friction - friction.sine * mesh.coast",
        "return along, mesh.drive_friction - friction.sine * mesh.coast",
        ("engine/test_hub_load.py::test_forces_of_the_coast_flank_are_those_of_the_drive_flank_turned",),
    ),
    Mutant(
        "a gear that holds with the friction of its hub alone, without the dry load",
        "engine/friction/forces.py",
        "margin = second_limit + joints[LOAD].by_load * loads.gear - abs(pairs.gear)",
        "margin = joints[LOAD].by_load * loads.gear - abs(pairs.gear)",
        ("engine/test_stick_slip.py", "engine/test_friction.py", "engine/test_hub_load.py"),
    ),
    Mutant(
        "a pair that rolls without the change of its levers",
        "engine/friction/forces.py",
        "held = (first * on_pinion - second * on_gear + pairs.sliding_rate) / inertia",
        "held = (first * on_pinion - second * on_gear) / inertia",
        ("engine/test_hub_load.py::test_a_pair_that_rolls_goes_on_rolling_while_its_levers_change",),
    ),
    Mutant(
        "contacts that age at rest and forget nothing in sliding",
        "laws/joint_law.py",
        "left = math.exp((begin - end) * forgetting)",
        "left = 1.0",
        ("engine/test_ageing.py",),
    ),
    Mutant(
        "losses in the joints without the change of their coefficients",
        "engine/observers/friction_losses.py",
        "(rate.by_load * load + rate.constant)",
        "rate.constant",
        ("engine/test_ageing.py::test_rates_of_the_powers_of_joints_that_age_are_those_along_the_motion",),
    ),
    Mutant(
        "loads of hubs without the acceleration of a film's gap",
        "engine/friction/pairs.py",
        "return float(noted.force_rate + noted.damping * gap_acceleration)",
        "return float(noted.force_rate)",
        ("engine/test_squeeze_film.py::test_hubs_carry_the_force_of_a_film",),
    ),
    Mutant(
        "a film whose force changes with the length of the contact",
        "engine/friction/pairs.py",
        "by_length = noted.force - noted.damping * noted.gap_rate",
        "by_length = noted.force",
        ("engine/test_squeeze_film.py::test_hubs_carry_the_force_of_a_film",),
    ),
    Mutant(
        "steps that pass over the least load of a hub whose pinion a pin pushes",
        "engine/friction/forces.py",
        "return max(pinion, ",
        "return max(0.0, ",
        ("engine/test_energy_balance.py::test_a_pinion_that_a_pin_pushes_while_it_rings",),
    ),
)
