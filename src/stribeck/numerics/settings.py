"""All numbers of the numerical core that are no property of the equations: what each is, and what breaks if it is wrong.

A number is a tolerance, a multiple of the machine precision, a safety factor that a test fixes, or a limit on work. It has
one name for the core, whoever reads it: two places that need the same kind of number share it.
"""

EPSILON = 2.0**-52  # Machine precision; what rounds away is a small multiple of it
SAFETY = 2.0  # Stated over estimated error where the estimate is of leading order
NEGLIGIBLE = 0.1  # Share of a tolerance, an error or a step that does not count beside the whole
ROUNDING = (
    16 * EPSILON
)  # Rounding of a nodal gap, a difference of terms of order one; with less, noise counts as error of the mesh
HALF_DIGITS = EPSILON**0.5  # What is smaller beside one is known to no digit in a difference quotient, or is no progress
SAME_PLACE = EPSILON**0.75  # Distance over the scale of a mesh below which two places are one: nodes between are the same

SHARE = 0.5  # Share of a tolerance that each of two causes of error may take: the states of a path and what lies between them

# Paths of states along ln of what varies.
MIN_LOG_STEP = 0.02  # Shortest step and interval: a path that needs a shorter one ends, an interval keeps its error
MAX_LOG_STEP = 6.0  # Longest step, and radius of convergence of series that show none
STEP_GROWTH = 2.0  # Largest ratio of neighbouring steps, and of a step to the one before that failed
MAX_PATH_STATES = 400  # Limit on work
WINDOW = 6  # Neighbouring states whose values and slopes a polynomial takes
INNER_PLACES = (0.25, 0.5, 0.75)  # Parts of an interval where it is checked: laws with kinks may agree by accident at one

# Safety factors of what is stated of balls, by tests/test_ball_errors.py: with less, true errors exceed stated ones.
# Each pair is the stated error over the difference of two meshes, and the least such difference over the largest of all.
SMOOTH_SAFETY, SMOOTH_FLOOR = 0.35, 0.1  # Flow that is smooth: errors fall exponentially, the finer mesh has hardly any
KINKED_SAFETY, KINKED_FLOOR = 1.0, 1.0  # Flow that thins or ends: errors fall as a power
# Flow that roughness closes, and gas carried by differences of first order: both meshes err by nearly the same.
SHARED_SAFETY, SHARED_FLOOR = 2.0, 1.0
NEAR_MINIMUM = 1.3  # Gap over its minimum up to which the difference of two gaps counts as error of the minimum

# Limits on work: with more, memory and time; with less, states that miss their tolerance or fail, and say so.
MAX_REFINEMENTS = 8  # Pairs of meshes tried for a state of a ball
MAX_ROUNDS = 40  # Rounds of a fixed-point iteration
MAX_DEGREE = 18  # Degree of panels
MAX_STEPS_NEW_MESH = 80  # Newton steps on a mesh other than the neighbour's, or from cold
MAX_STEPS_FROM_NEIGHBOUR = 15  # Newton steps on the mesh of a neighbour, before a cold start is cheaper
DROP_FACTORS_ABOVE_BYTES = 200_000_000  # Memory of a mesh above which factors of coarser ones are dropped

# First meshes and starts of balls, limits on work too: with others a state takes another refinement or more steps.
LEAST_DEGREE = 7  # Degree of panels of first meshes, and of the far film
FIRST_DEGREES, FIRST_MODES = (7, 8), (8, 10)  # Least degree and number of modes, of a full film and one that ends
DEGREE_LOG_GAIN, FIRST_ERROR = 1.49, 5.0  # ln of the error reduction by one degree, and the error without any
SMOOTH_BELOW_PRESSURE = 1e-3  # Largest contact pressure of a film whose angles are those of a smooth contact [p_Hz]
SMALL_TAIL = 0.1  # Last coefficients of the gap in one direction over the other's below which that is not refined
RIGID_START_SPEED = 2.0  # Speed above which a film that ends starts from that of a rigid ball

# Of the line: states that only start others, and limits on work.
COARSE_RTOL = 1e-3  # Tolerance of meshes and states that only start others; with more, these do not start them
COARSE_STEP = NEGLIGIBLE**2 * COARSE_RTOL  # Last step of Newton's iteration towards such a state; smaller ones may be rounding
COARSE_ORDER = 10  # Nodes per panel of such a state
MAX_PANELS = 128  # Panels of a mesh of the line
MAX_AMPLIFICATION = 40.0  # Sum of absolute weights of a prediction above which it uses fewer states, whose errors it amplifies

# Tolerances of the promise.
FLOOR = 1e-3  # Value below which the error of what crosses zero, the offset or a gap at rest, is not relative to it
MINIMUM_RTOL_FACTOR = 1000.0  # That of the minimum film over rtol
ROUNDING_RTOL_FRACTION = 0.03  # Rounding of friction over rtol from which a missed tolerance is put down to it
