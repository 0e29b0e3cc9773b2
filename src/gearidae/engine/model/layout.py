"""Where everything lies in the one flat array that the compiled residual reads.

SUNDIALS hands its callbacks a single pointer, so all that a scene comes down to travels in one float64 array:
constants, the tooth pairs' histories, the torque laws and the tables of the force law. The names below are offsets
into it. Everything is scaled: lengths by the roughness sigma, forces by a reference load of the scene, and time by
``tau = sqrt(m sigma / F)``, so that states, rates and forces are of order one whatever the speed.
"""

from __future__ import annotations

from typing import Final

# -- constants -------------------------------------------------------------------------------------------------------
KIND: Final = 0  # GEARS or ROLLER
SIGMA: Final = 1  # length unit [m]
TAU: Final = 2  # time unit [s]
FORCE: Final = 3  # force unit [N]
BASE_PITCH: Final = 4  # [m]
GEAR_RADIUS: Final = 5  # R2 [m]
PINION_RADIUS: Final = 6  # R1 [m]
PINION_TEETH: Final = 7
PINION_SHARE: Final = 8  # R1^2 tau^2 F / (I1 sigma): acceleration along the line of action per unit force
GEAR_SHARE: Final = 9  # R2^2 tau^2 F / (I2 sigma); for a roller tau^2 F / (m sigma)
HALF_BACKLASH: Final = 10  # b / sigma
PHASE_RATE: Final = 11  # sigma / pb: turns the gear's surface velocity into the rate of its phase
PATH: Final = 12  # path of contact in pitches (the contact ratio)
COAST_PHASE: Final = 13  # 2 approach / pb + 1/2: mirrors the coast flank about the pitch point
RELIEF: Final = 14  # pb^2 / (rho sigma): curvature of the tip relief
RELIEF_SLOPE: Final = 15  # pb / rho
REACH: Final = 16  # how far outside the path a pair may still touch, in pitches
START_RADIUS: Final = 17  # pinion's radius of curvature where contact begins, in pitches
SUM_CURVATURE: Final = 18  # 1 over the sum of both radii of curvature, per pitch
DAMPING: Final = 19  # viscous mesh damping, scaled
DRAG: Final = 20  # alpha, scaled: force per squared surface velocity
CUTOFF: Final = 21  # gap beyond which the force is taken as zero
ENGAGE: Final = 22  # gap of contact onset and separation
LOADING_AT: Final = 23  # loading branch of both materials together, in forces
MATERIALS: Final = 24  # records of the materials that stretch: bare first
MATERIAL: Final = 3  # numbers in each
M_FORCE: Final = 0  # force scale per sqrt(radius / pitch), with the material's share of the surface
M_STRETCH: Final = 1  # stretch limit dc / sigma; 0 where there is no hysteresis worth following
M_TABLE: Final = 2  # offset of its force law
DRY: Final = 30  # dry resistance at the gear: 1 if the scene has any
SLOTS: Final = 31  # pairs per flank whose history is kept, a power of two
ERROR_ORDERS: Final = 32  # number of harmonics of the static transmission error
ERROR_AT: Final = 33  # where they begin: order, amplitude / sigma, phase
DRIVE_AT: Final = 34  # where the torque laws begin
LOAD_AT: Final = 35
REST_SPEED: Final = 36  # slip speed that is told from rest, some tolerances
TOTAL_SLOTS: Final = 37  # both flanks
ROOT_LIMIT: Final = 38  # roots in succession allowed to be closer than ROOT_SPACING, times 1 + t
ROOT_SPACING: Final = 39
HISTORIES: Final = 40  # where the pairs' histories begin, and the size of one
HISTORY: Final = 41
BRANCH: Final = 42  # size of a material's branch at the end of a history; 0 if none is kept
NODES: Final = 43  # nodes per pair of the elastic contact; 0 for the asperity model
GRID_AT: Final = 44  # where their profile, weights and influence coefficients lie
ORDERS: Final = 45  # powers of the footprint's length in the influence coefficients
LENGTH_MIDDLE: Final = 46  # that length, counted from the middle of its range and over half of it
LENGTH_HALF: Final = 47
WEIGHTS_AT: Final = 61  # one over the absolute tolerance of every state
LOWEST_GAP: Final = 62  # the model holds above this gap of a pair
STATES: Final = 63  # number of states

# -- what changes during a run ---------------------------------------------------------------------------------------
TURNS: Final = 48  # whole pitches taken out of the phase
SLIP: Final = 49  # direction of the gear's slip against dry resistance: -1, +1; 0 while it is held at rest
LAST_TIME: Final = 50  # last accepted time
MARK_LOW: Final = 51  # phases of the nearest mesh entries and exits
MARK_HIGH: Final = 52
LAST_FLANK: Final = 53  # flank of the last onset, -1 before the first
LAST_ROOT: Final = 54  # time of the last root, and how many have come in close succession
ROOTS: Final = 55
NEXT_KNOT: Final = 56  # index of the coming schedule knot among all knots
NEAR: Final = 57  # two flags: drive and coast flank close enough for any pair to touch
MOVING: Final = 60  # 1 once a slip has become faster than REST_SPEED
PASSED: Final = 59  # 1 once a pair has been below LOWEST_GAP

# -- the energy ledger -----------------------------------------------------------------------------------------------
POTENTIAL_AT: Final = 64  # potential of the loading branch of both materials together
NUMBER_AT: Final = 65  # number of asperities above a height
ENERGIES: Final = 66  # per material: offset of its energy table, and what its asperities lose when they join
ENERGY: Final = 2
E_TABLE: Final = 0
E_JOINING: Final = 1  # in the unit of M_FORCE
# Sums over the run, energies in the unit of force times sigma.
SUMS: Final = 70
DRIVE_WORK: Final = 70
DRAG_LOSS: Final = 71
DRY_LOSS: Final = 72
DAMPING_LOSS: Final = 73
ADHESION_LOSS: Final = 74
RADIUS_WORK: Final = 75
MODEL_CHANGE: Final = 76
THROUGHPUT: Final = 77
START_STORED: Final = 78
START_KINETIC: Final = 79
DOUBT: Final = 80  # about how far the quadratures may be out
SUMS_END: Final = 81
LEDGER_TIME: Final = 81  # up to which they are kept, and accepted steps since
LEDGER_STEPS: Final = 82
# What the powers are made of there, each with its rate.
WAS_KINETIC: Final = 83
WAS_PINION: Final = 84  # travel of the pinion's base circle, its speed and the rate of that
WAS_SPEED: Final = 85
WAS_GAIN: Final = 86
WAS_GEAR: Final = 87  # the gear's
WAS_W: Final = 88
WAS_W_RATE: Final = 89
WAS_DRIVE: Final = 90  # torques over base radius
WAS_DRIVE_RATE: Final = 91
WAS_LOAD: Final = 92
WAS_LOAD_RATE: Final = 93
WAS_RADIUS: Final = 94  # power of the changing radius
WAS_RADIUS_RATE: Final = 95
WAS_BOOKED: Final = 96  # work of the radius on what joining losses booked since then have taken
# Time up to which drag and damping are kept, and what their powers were made of there.
RESIST_TIME: Final = 97
RESIST_GEAR: Final = 98
RESIST_W: Final = 99
RESIST_W_RATE: Final = 100
RESIST_V: Final = 101
RESIST_V_RATE: Final = 102
LEDGER_END: Final = 103
LEDGER_SPAN: Final = 103  # time over which steps may be gathered, and how many
LEDGER_STRIDE: Final = 104
LEDGER_DOUBT: Final = 105  # doubt from which on none are, over the throughput
LEDGER_PARTS: Final = 106  # into which a step in flight is divided
# Angular frequencies that the steps have to follow, 0 for none: of torques, scaled, and along the mesh, per pitch.
TORQUE_WAVE: Final = 107
MESH_WAVE: Final = 108
CONSTANTS: Final = 109

# -- the history of a tooth pair, in the slot `pair mod SLOTS` of its flank ------------------------------------------
PAIR: Final = 0  # number of the pair, counted without TURNS; what the slot is about
WAY: Final = 1  # sign of the gap rate; 0 at the very start
LAST_GAP: Final = 2  # gap and gap rate at the last accepted time
LAST_RATE: Final = 3
TOUCHING: Final = 4  # 1 between onset and separation
JOINED: Final = 5  # per material, height above which asperities are joined at the last turning point
TORN: Final = 7  # per material, 1 once full stretch has been reached on the way apart
BOOKED: Final = 9  # per material, energy of the asperities above JOINED that joining takes (asperity model)
BRANCHES: Final = 11  # per material, the force law's branch at JOINED; then those of the stored energy
# An elastic contact has these in place of the branches, then rows of one number per node, and per point between nodes:
LOADED: Final = 11  # 1 if the last evaluation found the pair within reach
LENGTH: Final = 12  # length of its footprint, sqrt(radius / pitch)
STRETCHED: Final = 13  # 1 if asperities were stretched at the last turning point
NODE_ROWS: Final = 14
ROW_GAP: Final = 0  # gap at the last accepted time
ROW_SHARE: Final = 1  # how far the node's gap moves with the pair's
ROW_PRESSURE: Final = 2  # of the last evaluation
ROW_SLOPE: Final = 3  # slope of the loading branch in the node's gap
ROWS: Final = 4
ROW_JOINED: Final = 4  # two rows of points, one per material: joined height
ROW_STIFFNESS: Final = 6  # of points: slope of what stretched asperities add, in the point's gap
ROW_BOOKED: Final = 7  # two rows of points: energy of what is joined, when nothing is stretched
POINT_ROWS: Final = 5
FINER: Final = 4  # steps from point to point in one from node to node

GEARS: Final = 0.0
ROLLER: Final = 1.0

# -- a torque law ----------------------------------------------------------------------------------------------------
# constant, number of harmonics, number of schedule points, then (amplitude, angular frequency, phase) of each
# harmonic and (time, value) of each point, forces and times scaled.
LAW_CONSTANT: Final = 0
LAW_HARMONICS: Final = 1
LAW_POINTS: Final = 2
LAW_SEGMENT: Final = 3  # index of the schedule's current segment: set at knots, never inside a step
LAW_BODY: Final = 4

# -- states ----------------------------------------------------------------------------------------------------------
U: Final = 0  # dynamic transmission error (a roller's height) / sigma
V: Final = 1  # its rate
PHASE: Final = 2  # gear's turn in base pitches, less TURNS
W: Final = 3  # gear's surface velocity at the base circle
# then, for an elastic contact, the deflection of both bodies / sigma at every node of every history's pair
