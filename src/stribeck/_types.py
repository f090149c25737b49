"""The one array type that annotations use."""

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
