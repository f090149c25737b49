"""The equations of the point contact on a polar mesh: residual, Jacobian, preconditioner, observables, errors."""
