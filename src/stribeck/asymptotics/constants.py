"""Universal constants of the limits, each computed by this package; ``tests`` compute them again.

Source: the similarity problems of :mod:`stribeck.asymptotics.film_layers` and :mod:`stribeck.asymptotics.edge_layer`.
"""

FILM_CONSTANT = 0.44583
r"""Central film over u_Hz lambda**(3/5) as lambda -> 0; [BP] print 0.44."""

PRINTED_FILM_CONSTANT = 0.44
"""The same as [BP] print it, for the printed forms of formulas."""
