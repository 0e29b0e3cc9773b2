"""``SCENE``: constants of a run, made from the scene and never read from a file.

Units in brackets: lengths in sigma, times in tau, forces in F, speeds in sigma/tau, angles along the mesh in base
pitches (pb) unless SI says otherwise; [1] has none, [index] counts in the tables or rows of the model.
"""

from __future__ import annotations

from typing import Final

from gearidae.engine.model.record_types import (
    INT,
    MATERIALS,
    REAL,
    SCHEDULES,
    record_type,
)
from gearidae.laws.frictions import LAWS_OF_SHAFTS
from gearidae.laws.joint_law import JOINT_FIELDS
from gearidae.laws.joints import JOINTS
from gearidae.laws.pairs import MESH_LAWS

MATERIAL: Final = record_type(
    ("force_scale", REAL),  # force per sqrt(radius / pb), with the material's share of the surface [F]
    ("gap_offset", REAL),  # by which its gap is wider than that of the pair [sigma]
    ("stretch_limit", REAL),  # 0 where there is no hysteresis worth following [sigma]
    ("joining_energy", REAL),  # lost by an asperity at contact onset [`force_scale` sigma]
    ("table_at", INT),  # force law among the tables [index]
    ("energy_at", INT),  # stored energy among the tables [index]
    ("number_at", INT),  # number of asperities above a height, among the tables [index]
    ("attraction", REAL),  # across a gap of 1, with the material's share, per sqrt(radius / pb) [F]
)

COVERAGE: Final = record_type(  # of one side's flanks
    ("teeth", INT),  # rows of the table, one after the other: of each tooth, or one for all [1]
    ("positions", INT),  # fractions in each, at equal parts of the path of contact [1]
    ("values_at", INT),  # the table among the tables [index]
    ("position_scale", REAL),  # fractions in a pitch [1/pb]
)

TORQUE: Final = record_type(  # of a shaft
    ("takes_angle", INT),  # 1 if a torque depends on the shaft's angle
    ("acts", INT),  # 1, 2, 4.. added up of the laws that act on it besides its driving torque
    ("resists", INT),  # 1, 2, 4.. added up of the set-valued laws that it has
    ("angle_unit", REAL),  # unit of the shaft's angle: sigma over the base radius [rad]
    *(field for law in LAWS_OF_SHAFTS for field in law.fields),
    *((constant.name, REAL) for law in LAWS_OF_SHAFTS for constant in law.coefficients),
)

SCHEDULE: Final = record_type(
    ("knot_count", INT),  # [1]
    ("knots_at", INT),  # time and value of each, then coefficients of the pieces of a cubic one [index]
    ("cubic", INT),  # 1 for monotone cubics between the knots, 0 for straight lines
)

POPULATION: Final = record_type(
    (
        "flanks",
        INT,
    ),  # of the pinion, both sides of each tooth, or one of a roller; 0 for the mean of many surfaces [1]
    (
        "starts_at",
        INT,
    ),  # of each level and flank the first asperity, and of each level one past the last [index]
    ("listed_at", INT),  # asperities of the levels, one level after the other, among the tables [index]
    ("arcs_at", INT),  # positions along the flank of all asperities, among the tables [index]
    ("heights_at", INT),  # their heights among the tables [index]
    ("kinds_at", INT),  # where the numbers of their kinds are, among the tables [index]
    ("by_gear_tooth", INT),  # 1 where kinds depend on the gear's tooth: these where it is covered there
    ("bare_kinds_at", INT),  # and these where it is bare, among the tables [index]
    ("gear_numbers_at", INT),  # coverage numbers of the gear's side, among the tables [index]
    ("highest", REAL),  # of their heights [sigma]
    ("join", REAL),  # farthest distance at which any joins [sigma]
    ("steepness", REAL),  # base pitch, or a roller's radius, over sigma [1]
    ("arc_scale", REAL),  # arc over the squared radius of curvature [1/pb]
    ("capacity", INT),  # candidates of a pair at most [1]
    ("rows_at", INT),  # candidates of all histories among the rows [index]
    ("quiet", INT),  # 1 where events of single asperities are not recorded
    ("digest", REAL, (4,)),  # of all asperities [1]
)

FRICTION: Final = record_type(  # of flanks and joints: hubs and the pin of a drive
    ("may_stick", INT),  # 1 if friction may hold anything: flanks, joints, or a set-valued law of a shaft
    (
        "any_friction",
        INT,
    ),  # 1 if not the gear alone: flanks, joints, a law of the pinion; or loads are followed
    ("flanks", INT),  # 1 if flanks have
    ("joints", INT),  # 1 if a joint has a radius, so that loads are followed
    ("hubs", INT),  # 1 if a hub has friction that grows with its load
    ("ages", INT),  # 1 if friction of a joint grows with the time at rest
    ("rubs", INT, (2,)),  # 1 if a joint of the shaft has friction
    ("forced", INT),  # 1 if the drive pushes with a pin
    ("holding", INT),  # kinds of dry friction: a sum of values of `gearidae.records.standing.Holding`
    ("even", REAL),  # coefficient of all materials; 0 where they differ, or the law is another [1]
    ("scale", REAL, (MATERIALS,)),  # limits of the materials' friction, as `force_scale` [F]
    ("table_at", INT, (MATERIALS,)),  # laws of the limits among the tables [index]
    ("loading_at", INT),  # their loading branch among the tables, as that of the forces [index]
    ("shear", INT),  # 1 where limits are shear strengths times areas
    ("pinion_lever", REAL),  # base pitch over the pinion's base radius [1]
    ("gear_lever", REAL),  # base pitch over the gear's base radius [1]
    ("radii", REAL),  # sum of both radii of curvature [pb]
    ("pinion_lever_slope", REAL),  # sigma over the pinion's base radius [1]
    ("gear_lever_slope", REAL),  # sigma over the gear's base radius [1]
    ("joint", record_type(*JOINT_FIELDS), (len(JOINTS),)),  # by its number
    (
        "pin_cosine",
        REAL,
    ),  # of the angle of the force's axes from the line of action's normal, per newton [F/N]
    ("pin_sine", REAL),  # of that angle, per newton [F/N]
    ("cosine", REAL),  # of twice the pressure angle [1]
    ("sine", REAL),  # of twice the pressure angle [1]
    (
        "gap_tolerance",
        REAL,
    ),  # error of the transmission error within which the force of a pair is known [sigma]
)

FOLLOW: Final = record_type(  # 1 for each observer of the run that is wanted
    ("balance", INT),  # energy balance, and joining for it
    ("friction", INT),  # losses by friction, for it
    ("extremes", INT),  # extremes of the run
    ("exposures", INT),  # exposures of the flanks
    ("passages", INT),  # table of passages
    ("impacts", INT),  # table of impacts
    ("gear", INT),  # extremes of the gear's speed, and where it stands
)

MESH_CONSTANTS: Final = tuple(constant for law in MESH_LAWS for constant in law.constants)
"""Fields with the number of a key of the mesh in the units of the run; 0 for a roller."""

SCENE: Final = record_type(
    ("follow", FOLLOW),
    ("kind", INT),  # GEARS or ROLLER: what is recorded
    ("length_unit", REAL),  # sigma [m]
    ("time_unit", REAL),  # tau [s]
    ("force_unit", REAL),  # F [N]
    # the mesh
    ("base_pitch", REAL),  # pb [m]
    ("gear_radius", REAL),  # base radius R2 [m]
    ("pinion_radius", REAL),  # base radius R1 [m]
    ("pinion_teeth", REAL),  # [1]
    ("pinion_inverse_mass", REAL),  # R1^2 tau^2 F / (I1 sigma): acceleration per force; 1 of a roller [1]
    ("gear_inverse_mass", REAL),  # R2^2 tau^2 F / (I2 sigma); 0 where the gear is held [1]
    # gap on the path at u = 0 by flank; infinite where it meets none [sigma]; with an orbit of the pinion that of the
    # coast flank is the one of the time that is looked at
    ("clearance", REAL, (2,)),
    ("phase_rate", REAL),  # sigma / pb: rate of the phase per surface velocity of the gear [1]
    ("contact_ratio", REAL),  # path of contact [pb]
    ("coast_phase", REAL),  # 2 approach / pb + 1/2: mirrors the coast flank about the pitch point [pb]
    ("relief_curvature", REAL),  # pb^2 / (rho sigma): curvature of the tip relief [sigma/pb^2]
    ("relief_slope", REAL),  # pb / rho [1/pb]
    ("reach", REAL),  # how far outside the path a pair may still touch [pb]
    ("marks", INT),  # kinds of marks of the mesh in each pitch; 0 where the gear is held [1]
    ("start_radius", REAL),  # pinion's radius of curvature where contact begins [pb]
    ("sum_curvature", REAL),  # 1 over the sum of both radii of curvature [1/pb]
    ("curvature_force", INT),  # 1 if a force pays for the changing contact length
    ("pair_laws", INT),  # 1, 2, 4.. added up of the laws of its pairs, see `gearidae.engine.laws.pairs`
    *((constant.name, REAL) for constant in MESH_CONSTANTS),
    ("error_count", INT),  # harmonics of the pinion's angle: static error and its own runout [1]
    ("error_at", INT),  # order, amplitude and phase of each, among the tables [index]
    ("torque", TORQUE, (2,)),  # of the pinion (DRIVE) and of the gear (LOAD)
    ("schedule", SCHEDULE, (SCHEDULES,)),  # of both torques and of the speed that the drive holds (SPEED)
    # the contact
    ("cutoff", REAL),  # gap beyond which the force is taken as zero [sigma]
    ("contact_gap", REAL),  # gap of contact onset and separation [sigma]
    ("lowest_gap", REAL),  # the model holds above this gap of a pair [sigma]
    ("light_gap", REAL),  # gap in the middle of elastic contacts above which rigid ones would do [sigma]
    ("material", MATERIAL, (MATERIALS,)),
    (
        "covered_by_position",
        INT,
    ),  # 1 where shares change with tooth and position and are not in the force scales
    ("patches", INT),  # 1 where the pinion's fractions are those of the interface
    ("coverage", COVERAGE, (2,)),  # of the pinion and of the gear
    (
        "loading_at",
        INT,
    ),  # loading branch of all materials, or with `covered_by_position` of each, in forces [index]
    ("potential_at", INT),  # potentials of these branches [index]
    ("slots", INT),  # histories per flank in use, a power of two [1]
    ("histories", INT),  # histories of all flanks [1]
    ("branch_length", INT),  # numbers of a branch of the force law; 0 if none is kept [1]
    ("branches_at", INT),  # where these branches begin among the rows [index]
    # nodes of an elastic contact
    ("nodes", INT),  # per pair; 0 for the asperity model [1]
    ("points", INT),  # the nodes and what lies between them [1]
    ("orders", INT),  # powers of the contact length in the influence coefficients [1]
    ("length_middle", REAL),  # middle of the range of that length [sqrt(pb)]
    ("length_half_range", REAL),  # half of that range [sqrt(pb)]
    ("profile_at", INT),  # profile of the nodes, among the tables [index]
    ("weights_at", INT),  # weights of the nodes, among the tables [index]
    ("influence_at", INT),  # influence coefficients, among the tables [index]
    ("point_profile_at", INT),  # profile of the points, among the tables [index]
    ("point_weights_at", INT),  # weights of the points, among the tables [index]
    ("shares_at", INT),  # shares of the nodes around each point, among the tables [index]
    ("node_rows_at", INT),  # where the pairs' nodes begin among the rows [index]
    ("node_row_length", INT),  # numbers of one pair's nodes there [1]
    ("point_branch_length", INT),  # numbers of a branch of stretched asperities at a point; 0 if none [1]
    ("point_branches_at", INT),  # where those of all pairs begin among the rows [index]
    ("scratch_at", INT),  # scratch space for them, among the rows [index]
    ("trial_at", INT),  # where a state whose nodes are eliminated gets its deflections, in rows [index]
    # what flanks are exposed to
    ("bins", INT),  # along the path of contact, `place` in a dataset; 0 if no exposures are kept [1]
    ("bins_per_pitch", REAL),  # [1/pb]
    ("pitch_point", REAL),  # on the path of contact [pb]
    ("sliding_pinion", REAL),  # sliding speed a pitch from there, over the pinion's surface velocity [1]
    ("sliding_gear", REAL),  # over the gear's surface velocity [1]
    ("exposure_rows", INT),  # sums of a tooth, each over all bins [1]
    ("exposures_at", INT),  # sums of the flanks among the rows [index]
    ("exposures", INT),  # numbers there [1]
    # the run
    ("states", INT),  # numbers in the state vector [1]
    ("scale_at", INT),  # what an error of 1 means for each state, among the tables [index]
    ("error_weights_at", INT),  # one over the absolute tolerance of each state, among the rows [index]
    ("rtol", REAL),  # relative tolerance [1]
    ("start", REAL),  # when the run begins: 0, or the end of the run that it goes on from [tau]
    ("end", REAL),  # when it ends [tau]
    ("samples", INT),  # in the whole run, the first at its start; 0 for none [1]
    ("first_sample", REAL),  # the start over the time between two samples [1]
    ("knot_count", INT),  # stops inside the run: knots of schedules and checkpoints [1]
    ("knots_at", INT),  # their times among the tables [index]
    ("checkpoints_at", INT),  # for each 1 if a checkpoint is kept there, among the tables [index]
    ("stop", INT),  # what ends the run before its time: see `STOPS`
    ("stop_from", REAL),  # position of the gear from which its turns are counted [pb]
    ("stop_pitches", REAL),  # pitches of the turns that end the run [pb]
    ("root_limit", INT),  # roots in succession allowed to be closer than `root_spacing` [1]
    ("root_spacing", REAL),  # times 1 + t [tau]
    ("torque_omega", REAL),  # highest angular frequency of the torques that steps follow [rad/tau]
    ("longest_step", REAL),  # that harmonics, laws and cubic schedules allow; 0 for any [tau]
    ("largest_step", REAL),  # that the scene allows; 0 for any [tau]
    ("tied", INT),  # 1 if a law keeps the shafts from turning on for ever
    ("guarded", INT),  # 1 if a law that acts on a shaft switches
    ("law_columns", INT),  # columns of samples that laws of the shafts write [1]
    ("law_switches", INT),  # 1 if a law has a function whose zeros are where it switches
    ("law_watched", INT),  # 1 if it has, or says nothing of where it jumps, so that each step looks at it
    (
        "rest_search_step",
        REAL,
    ),  # longest time between two looks at the torques of what is held; infinite for any [tau]
    ("rest_margin_curvature", REAL),  # bound of the second derivative of their harmonics [F/tau^2]
    ("common_period", REAL),  # of all harmonics; 0 if they have none [tau]
    ("free_step", REAL),  # longest step of free gears, whatever the tolerance; 0 for any [tau]
    ("angle_omega", REAL),  # highest angular frequency of the torques of an angle [rad/pb]
    ("mesh_omega", REAL),  # highest angular frequency along the mesh [rad/pb]
    ("quadrature_steps", INT),  # accepted steps that the energy balance integrates over at once [1]
    ("quadrature_time", REAL),  # over which they may last [tau]
    ("balance_error", REAL),  # error over throughput from which on it takes single steps [1]
    ("flight_parts", INT),  # into which it divides a step in flight [1]
    # last, so that what every step reads lies as close together as without it
    ("population", POPULATION),  # real asperities on the flanks
    ("attracts", INT),  # 1 if flanks attract each other across the gap
    ("attraction_floor", REAL),  # gap below which the attraction grows no further [sigma]
    ("friction", FRICTION),  # of flanks and hubs
    ("noting", INT),  # 1 where the forces of single pairs are noted, for exposures, friction or nodes
    ("gear_teeth", REAL),  # [1]
    ("phase_high", REAL),  # phase at which whole pitches are taken out of it [pb]
    ("nearest", REAL, (2,)),  # clearance of the teeth that stand out farthest, by flank [sigma]
    ("pitch_errors", INT),  # 1 if teeth have errors of their own
    ("pinion_errors_at", INT),  # those of the pinion's teeth among the tables [index]
    ("gear_errors_at", INT),  # and those of the gear's [index]
    ("has_error", INT),  # 1 if the mesh has an error of the angles: static error or runout
    ("gear_runout", REAL),  # amplitude of the gear's runout [sigma]
    ("gear_runout_phase", REAL),  # its phase [rad]
    ("orbit", REAL),  # clearance of the pinion's hub; 0 for a pinion that does not orbit [sigma]
    ("orbit_play", REAL),  # twice the clearance times the sine of the pressure angle [sigma]
    ("orbit_sine", REAL),  # components of the line of action in the axes of the drive's force [1]
    ("orbit_cosine", REAL),  # [1]
    ("orbit_x", REAL),  # and of the line of the centres [1]
    ("orbit_y", REAL),  # [1]
    ("orbit_nearest", REAL),  # gap of the coast teeth that stand out farthest, less the clearance [sigma]
    ("orbit_step", REAL),  # between two values of the direction of the force, at most [tau]
)
