"""Universal constants of the limits, each computed by this package; ``tests/test_layers.py`` computes them again.

All digits are correct.  Source: the similarity problems of :mod:`stribeck.asymptotics.film_layers` and
:mod:`stribeck.asymptotics.edge_layer`.
"""

import math

FILM_CONSTANT = 0.445830450  # Central film over u_Hz lambda**(3/5) as lambda -> 0, selected by the inlet; [BP] print 0.44.

# Central film of the ball over u_Hz lambda**(3/5) as lambda -> 0, 0.424803126: the line's inlet, on a half-space.
BALL_FILM_CONSTANT = FILM_CONSTANT * (math.pi / 4) ** 0.2

PRINTED_FILM_CONSTANT = 0.44  # Central film over u_Hz lambda**(3/5) as [BP] print it, for the printed forms of formulas.

# Minimum film over u_Hz lambda**(3/5) as lambda -> 0, in the outlet: 0.75801004 of the central film.
MINIMUM_CONSTANT = 0.33794396

MINIMUM_POSITION = 0.40117  # Position of that minimum, as (x - 1)/lambda**(2/5).

# H(0) of a rough contact at rest as kappa -> 0: h = kappa (-ln(F)/2 - ln(kappa)/3 + H(0)) at the edge, x = 1 - kappa.
EDGE_GAP = -0.00219080859

EDGE_PRESSURE = 1.00219321  # Pressure at that edge over p_Hz kappa**(1/3), exp(-H(0)).
