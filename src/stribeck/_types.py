"""The array types that annotations use."""

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
Indices = NDArray[np.intp]
Flags = NDArray[np.bool_]

Numbers = float | Array
"""One number, or a column of them where states are stacked."""
