"""Print up to two BLAS kernels that this processor can run beside its own, one a line: values of OPENBLAS_CORETYPE.

OpenBLAS does not check a kernel that is asked for by name: whether it takes effect threadpoolctl tells, and whether the
processor can run it shows when it does.
"""

import os
import subprocess
import sys

KERNELS = ("Haswell", "SkylakeX", "Sandybridge", "Nehalem", "NEOVERSEN1", "ARMV8")
WANTED = 2

PROBE = """
import numpy, scipy.linalg, threadpoolctl
matrix = numpy.random.default_rng(1).random((300, 300)) + 300 * numpy.eye(300)
for function in (numpy.linalg.inv, scipy.linalg.inv):
    assert abs(function(matrix) @ matrix - numpy.eye(300)).max() < 1e-9
print(*sorted({pool["architecture"] for pool in threadpoolctl.threadpool_info() if pool["internal_api"] == "openblas"}))
"""


def architecture(kernel: str | None) -> str:
    """Return the kernels that OpenBLAS uses when ``kernel`` is asked for; empty where they do not run."""
    environment = {name: value for name, value in os.environ.items() if name != "OPENBLAS_CORETYPE"}
    if kernel is not None:
        environment["OPENBLAS_CORETYPE"] = kernel
    done = subprocess.run([sys.executable, "-c", PROBE], env=environment, capture_output=True, text=True, check=False)
    return done.stdout.strip() if done.returncode == 0 else ""


def main() -> None:
    """Print the kernels."""
    own = architecture(None)
    used, chosen = {own, ""}, []
    for kernel in KERNELS:
        if len(chosen) < WANTED and (found := architecture(kernel)) not in used:
            used.add(found)
            chosen.append(kernel)
    print(f"BLAS kernel of this machine: {own or 'not OpenBLAS'}; others that it runs: {chosen}", file=sys.stderr)
    print(*chosen, sep="\n")


if __name__ == "__main__":
    main()
