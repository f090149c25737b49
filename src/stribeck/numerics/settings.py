"""All numbers of the numerical core that are no property of the equations: what each is, and what breaks if it is wrong.

A number is a tolerance, a multiple of the machine precision, a safety factor that a test fixes, or a limit on work. It has
one name for the core, whoever reads it: two places that need the same kind of number share it.
"""

EPSILON = 2.0**-52  # Machine precision; what rounds away is a small multiple of it
SAFETY = 2.0  # Stated over estimated error where the estimate is of leading order
NEGLIGIBLE = 0.1  # Share of a tolerance, an error or a step that does not count beside the whole
# Rounding of a nodal gap, a difference of terms of order one; with less, noise counts as error of the mesh.
ROUNDING = 16 * EPSILON
HALF_DIGITS = EPSILON**0.5  # What is smaller beside one is known to no digit in a difference quotient, or is no progress
LOG_STEP = HALF_DIGITS**0.5  # Step of a logarithm in central differences: they err by its square, and rounding by less
SAME_PLACE = EPSILON**0.75  # Distance over the scale of a mesh below which two places are one: nodes between are the same

SHARE = 0.5  # Share of a tolerance that each of two causes of error may take: the states of a path and what lies between them

# Paths of states along ln of what varies.
MIN_LOG_STEP = 0.02  # Shortest step and interval, a table's too: a shorter one ends a path, and an interval keeps its error
MAX_LOG_STEP = 6.0  # Longest step, and radius of convergence of series that show none; longer ones pass over what is between
STEP_GROWTH = 2.0  # Largest ratio of neighbouring steps, and of a step that failed to the next; with more, more steps fail
MAX_STATES = 400  # States of a path, and neighbours that are kept: a limit on work and memory
WINDOW = 6  # Neighbouring states whose values and slopes a polynomial takes; with fewer a curve needs more states
# Degree of polynomials: series, values between states, panels of a ball; with more they hold rounding.
MAX_DEGREE = 18
# Rounding of coefficients, magnified by the equations that they solve: a radius of convergence is read off larger ones.
COEFFICIENT_NOISE = EPSILON**0.75
INNER_PLACES = 3  # Places, evenly apart, where an interval is checked: laws with kinks may agree by accident at one

# Of balls: what two meshes tell of errors, by tests/test_ball_errors.py.
SMOOTH_SAFETY = 0.5  # Stated error over the difference of two meshes where errors fall exponentially; with less, too small
NEAR_MINIMUM = 1.3  # Gap over its minimum up to which the difference of two gaps counts as error of the minimum

# Limits on work: with more, memory and time; with less, states that miss their tolerance or fail, and say so.
MAX_REFINEMENTS = 8  # Pairs of meshes tried for a state of a ball, and times that its panels are split
MAX_STEPS = 60  # Steps of an iteration: Newton's, a fixed point's, or those of GMRES for one step of Newton's
GMRES_RTOL = 3e-2  # Relative error of a step of Newton's iteration that GMRES may leave
REBUILD_AT = 12  # Steps of GMRES, or nodes that changed sides, above which a film that ends has a new preconditioner
BAND, MAX_BAND = 5, 16  # Angular modes that the preconditioner couples, and where these do not serve
LEAST_DEGREE = 7  # Degree of panels of a ball, and of the table of a flow curve
LEAST_MODES = LEAST_DEGREE + 1  # Angular modes of first meshes: as many as nodes of a panel
MAX_MODES = 200  # Angular modes
MAX_BYTES = 670_000_000  # Memory of operators and preconditioner of a mesh

# Meshes of balls, limits on work too: with others a state takes another refinement or more nodes.
PANEL_GROWTH = 2.5  # Ratio of the widths of neighbouring panels
FAR_GROWTH = 2.0 * PANEL_GROWTH  # Ratio of the radii of panels far out, where the film is known but for little
# Factor by which pressures with the square root of an edge fall per degree, on panels that grow from it: the axes of the
# ellipse through the edge around one of them.
LEGENDRE_DECAY = (PANEL_GROWTH**0.5 + 1.0) / (PANEL_GROWTH**0.5 - 1.0)
MODES_RATIO = 1.4  # Ratio of the modes of a pair of meshes

# Of the line: states that only start others, and limits on work.
COARSE_RTOL = 1e-3  # Tolerance of meshes and states that only start others; with more, these do not start them
COARSE_STEP = NEGLIGIBLE**2 * COARSE_RTOL  # Last step of Newton's iteration towards such a state; smaller ones may be rounding
COARSE_ORDER = 10  # Nodes per panel of such a state; with eight, a golden state of the line leaves its stated error
MAX_STEPS_ON_PATH = 15  # Newton steps towards such a state; with more, a golden film that ends, of Barus' fluid, is not found
MAX_PANELS = 128  # Panels of a mesh of the line
# Nodes that panels gain for the error estimate: with two it sees a fifth of errors on wide panels; even.
EXTRA_NODES = 4
PLACES_AROUND_NODE = 65  # At which the peak of the pressure is sought: it errs by a thousandth of what the highest node does
DEFECT_SAFETY = 3.0  # Stated error over that estimated on finer nodes; with two, four of 864 golden states of the line miss it
SPLIT_MARGIN = 1.05  # Number of panels over that which just resolves the fields; with less, states need another refinement
SIGN_PATTERNS = 5  # Patterns of signs of rounding errors: their mean square is right within a factor of two, with fewer not
# Sum of absolute weights above which a polynomial takes fewer states: it would make negligible errors of theirs whole.
MAX_AMPLIFICATION = 1.0 / NEGLIGIBLE

# Tolerances of the promise.
FLOOR = 1e-3  # Gap at rest over kappa below which its error is not relative to it
MIN_RTOL, MIN_RTOL_OF_BALLS, MAX_RTOL = 1e-11, 1e-8, 1e-2  # Tolerances that may be asked for
MINIMUM_RTOL_FACTOR = 1000.0  # That of the minimum film of a ball over rtol; with less, side lobes ask for many more angles

# Residual of the slopes of a state over the tolerance of the state: with the preconditioner of a neighbour their error is a
# hundred times that.  To solve them to rounding takes a sixth more of a fit of a ball in Carreau's fluid.
SLOPE_RESIDUAL = 1e-3
