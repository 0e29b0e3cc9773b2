"""``SCENE``: constants of a run, made from the scene and never read from a file."""

from __future__ import annotations

from typing import Final

from gearidae.engine.model.record_types import (
    INT,
    MATERIALS,
    REAL,
    SCHEDULES,
    record_type,
)

__all__ = [
    "COVERAGE",
    "FOLLOW",
    "MATERIAL",
    "POPULATION",
    "SCENE",
    "SCHEDULE",
    "TORQUE",
]

MATERIAL: Final = record_type(
    ("force_scale", REAL),  # per sqrt(radius / pitch), with the material's share of the surface
    ("gap_offset", REAL),  # by which its gap is wider than that of the pair, over sigma
    ("stretch_limit", REAL),  # over sigma; 0 where there is no hysteresis worth following
    ("joining_energy", REAL),  # energy lost by an asperity at contact onset, in the unit of `force_scale`
    ("table_at", INT),  # where its force law and its stored energy begin among the tables,
    ("energy_at", INT),
    ("number_at", INT),  # and the number of its asperities above a height
    ("table_count", INT),  # numbers in each
)

COVERAGE: Final = record_type(  # of one side's flanks
    ("teeth", INT),  # rows, one after the other: of each tooth, or one for all
    ("places", INT),  # fractions in each, at equal parts of the path of contact
    ("values_at", INT),
    ("place_scale", REAL),  # places in a pitch
)

TORQUE: Final = record_type(
    ("constant", REAL),
    ("harmonic_count", INT),  # (amplitude, angular frequency, phase) of each
    ("harmonics_at", INT),
    ("law_count", INT),  # parameters of the law, whose address is in `WORK`
    ("law_at", INT),
    ("law_torque", REAL),  # units of the law's torque [N m] and of the shaft's speed [rad/s]
    ("law_speed", REAL),
)

SCHEDULE: Final = record_type(
    ("knot_count", INT),  # (time, value) of each, then the coefficients of the pieces of a cubic one
    ("knots_at", INT),
    ("cubic", INT),  # 1 for monotone cubics between the knots, 0 for straight lines
)

POPULATION: Final = record_type(
    (
        "flanks",
        INT,
    ),  # of the pinion, both sides of each tooth, or one of a roller; 0 for the mean of many surfaces
    (
        "starts_at",
        INT,
    ),  # among the tables, for each level: the first asperity of each flank, and one past the last
    (
        "listed_at",
        INT,
    ),  # asperities of the levels, where one past the last of a level is the first of the next
    ("arcs_at", INT),  # of all asperities places along the flank, heights over sigma, and where their kind is
    ("heights_at", INT),
    ("kinds_at", INT),
    ("highest", REAL),  # of their heights,
    ("join", REAL),  # and farthest distance at which any joins
    ("steepness", REAL),  # base pitch, or a roller's radius, over sigma
    ("arc_scale", REAL),  # arc over the squared radius of curvature, per base pitch
    ("capacity", INT),  # candidates of a pair at most
    ("rows_at", INT),  # where they begin among the rows
    ("quiet", INT),  # 1 where events of single asperities are not recorded
    ("digest", REAL, (4,)),  # of all asperities
)

FOLLOW: Final = record_type(  # 1 for each follower of the run that is wanted
    ("balance", INT),
    ("extremes", INT),
    ("exposures", INT),
)

SCENE: Final = record_type(
    ("follow", FOLLOW),
    ("kind", INT),  # GEARS or ROLLER
    ("length_unit", REAL),  # sigma [m]
    ("time_unit", REAL),  # tau [s]
    ("force_unit", REAL),  # [N]
    # the mesh
    ("base_pitch", REAL),  # [m]
    ("gear_radius", REAL),  # R2 [m]
    ("pinion_radius", REAL),  # R1 [m]
    ("pinion_teeth", REAL),
    (
        "pinion_inverse_mass",
        REAL,
    ),  # R1^2 tau^2 F / (I1 sigma): acceleration along the line of action per force
    ("gear_inverse_mass", REAL),  # R2^2 tau^2 F / (I2 sigma); of a roller tau^2 F / (m sigma)
    ("half_backlash", REAL),  # b / sigma
    ("phase_rate", REAL),  # sigma / pb: turns the gear's surface velocity into the rate of its phase
    ("contact_ratio", REAL),  # path of contact in pitches
    ("coast_phase", REAL),  # 2 approach / pb + 1/2: mirrors the coast flank about the pitch point
    ("relief_curvature", REAL),  # pb^2 / (rho sigma): curvature of the tip relief
    ("relief_slope", REAL),  # pb / rho
    ("reach", REAL),  # how far outside the path a pair may still touch, in pitches
    ("start_radius", REAL),  # pinion's radius of curvature where contact begins, in pitches
    ("sum_curvature", REAL),  # 1 over the sum of both radii of curvature, per pitch
    ("radius_force", INT),  # whether a force pays for the changing contact length
    ("damping", REAL),  # viscous mesh damping
    ("drag", REAL),  # force per squared surface velocity,
    ("viscous", REAL),  # and per surface velocity
    ("dry", INT),  # whether there is dry resistance at the gear
    ("error_count", INT),  # harmonics of the static transmission error: order, amplitude / sigma, phase
    ("error_at", INT),
    ("torque", TORQUE, (2,)),  # of the pinion (DRIVE) and of the gear (LOAD)
    ("schedule", SCHEDULE, (SCHEDULES,)),  # of both torques and of the speed that the drive holds (SPEED),
    (
        "speed_gain",
        REAL,
    ),  # and force over what the pinion's surface velocity is short of that; 0 if none is held
    # the contact
    ("cutoff", REAL),  # gap beyond which the force is taken as zero
    ("contact_gap", REAL),  # gap of contact onset and separation
    ("lowest_gap", REAL),  # the model holds above this gap of a pair
    ("light_gap", REAL),  # gap in the middle of elastic contacts above which the asperity model would do
    ("material", MATERIAL, (MATERIALS,)),
    ("by_place", INT),  # 1 where shares change with tooth and place and are not in the force scales
    ("loadings_at", INT),  # their loading branches over the pair's gap, in forces, side by side,
    ("potentials_at", INT),  # the potentials of these, and numbers of asperities above the gap
    ("numbers_at", INT),
    ("patches", INT),  # 1 where the pinion's fractions are those of the interface
    ("coverage", COVERAGE, (2,)),  # of the pinion and of the gear
    ("loading_at", INT),  # loading branch of all materials together, in forces
    ("potential_at", INT),  # potential of that branch
    ("population", POPULATION),
    ("slots", INT),  # histories per flank in use, a power of two, and of all flanks
    ("histories", INT),
    ("branch_length", INT),  # size of a branch of the force law or the stored energy; 0 if none is kept
    ("branches_at", INT),  # where they begin among the rows
    # nodes of an elastic contact
    ("nodes", INT),  # per pair; 0 for the asperity model
    ("points", INT),  # the nodes and what lies between them
    ("orders", INT),  # powers of the contact length in the influence coefficients
    ("length_middle", REAL),  # that length, counted from the middle of its range and over half of it
    ("length_half_range", REAL),
    ("profile_at", INT),  # among the tables: of nodes profile, weights and influence coefficients,
    ("weights_at", INT),
    ("influence_at", INT),
    ("point_profile_at", INT),  # of points profile, weights and shares of the nodes around each
    ("point_weights_at", INT),
    ("shares_at", INT),
    ("node_rows_at", INT),  # where the pairs' nodes begin among the rows
    ("node_row_length", INT),  # numbers of one pair's nodes there
    ("point_branch_length", INT),  # size of the branch of stretched asperities at a point; 0 if none is kept
    ("point_branches_at", INT),  # where those of all pairs begin among the rows
    ("scratch_at", INT),  # scratch space for them, among the rows
    ("trial_at", INT),  # where a state whose nodes are eliminated gets its deflections, among the rows
    # what flanks are exposed to
    ("places", INT),  # along the path of contact; 0 if it is not asked for
    ("places_per_pitch", REAL),
    ("pitch_point", REAL),  # on the path of contact, in pitches
    ("sliding_pinion", REAL),  # sliding speed a pitch from there, over either gear's surface velocity
    ("sliding_gear", REAL),
    ("exposures_at", INT),  # among the rows
    ("exposures", INT),  # numbers there
    # the run
    ("states", INT),
    ("scale_at", INT),  # what an error of 1 means for each state, among the tables
    ("error_weights_at", INT),  # one over the absolute tolerance of each state, among the rows
    ("rtol", REAL),
    ("start", REAL),  # time at which the run begins: 0, or the end of the run that it goes on from,
    ("end", REAL),  # and ends
    ("samples", INT),  # in the whole run, the first at its start; 0 for none
    ("first_sample", REAL),  # the start over the time between two samples
    (
        "knot_count",
        INT,
    ),  # stops inside the run, knots of schedules and checkpoints, among the tables: times,
    ("knots_at", INT),
    ("checkpoints_at", INT),  # and for each 1 if a checkpoint is kept there
    ("stop", INT),  # what ends the run before its time: see `STOPS`
    ("stop_from", REAL),  # place of the gear in pitches from which its turns are counted,
    ("stop_pitches", REAL),  # and how many pitches make the turns
    ("rest_speed", REAL),  # smallest slip speed that counts as motion
    ("root_limit", INT),  # roots in succession allowed to be closer than `root_spacing`, times 1 + t
    ("root_spacing", REAL),
    ("torque_omega", REAL),  # highest angular frequency of the torques that steps have to follow
    (
        "longest_step",
        REAL,
    ),  # that a cubic schedule allows, which may be flat where a pulse is to come; 0 for any
    ("mesh_omega", REAL),  # and along the mesh, per pitch
    ("balance_steps", INT),  # accepted steps that the energy balance integrates over at once,
    ("balance_span", REAL),  # over which they may last,
    ("balance_error", REAL),  # error over throughput from which on it takes single steps,
    ("flight_parts", INT),  # and into which it divides a step in flight
)
