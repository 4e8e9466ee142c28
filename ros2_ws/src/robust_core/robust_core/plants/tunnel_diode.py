"""The tunnel diode circuit of section 3.3: its current is estimated from a disturbed voltage.

States: the voltage of the capacitor (V), within +-3 V, and the current of the inductor (A). The thesis prints an
inductance of 2 H; its matrices are those of 1 H (erratum 3.3-data). The weights come in two pairs that each sum to 1/2,
so the printed vertices are not attained: :func:`tunnel_diode` gives them, ``tunnel_diode().attained()`` the true ones.
"""

from typing import Any

import numpy as np

from robust_core.models import FilterPlant
from robust_core.rational import Floats

CAPACITANCE_F = 0.02
INDUCTANCE_H = 1.0
DIODE = (0.002, 0.01)
"""Current of the diode: l1 v + l2 v^3."""

BOX = 3.0
RESISTANCE_OHM = (7.0, 13.0)
GROUPS = ((0, 1), (2, 3))
CIRCLE = ("-20", "19.9")
"""Centre and radius of the disc that the poles of the filtering error must lie in."""

PRINTED_FILTER = {
    "A": (("-7.5290", "43.6298"), ("0.0337", "-7.0407")),
    "B": (("0.5557",), ("1.2906",)),
    "C": (("0.0249", "-0.7337"),),
}


def tunnel_diode() -> FilterPlant:
    """The circuit on the printed vertices."""
    damping = (("-9.1", "-10"), ("-0.1", "-10"), ("-0.1", "-16"), ("-0.1", "-4"))
    return FilterPlant.of(
        A=np.array([[[first, 50], [-1, last]] for first, last in damping], dtype=object),
        B=[[0], [1]],
        C=[[0, 1]],
        D=[[0]],
        E=[[1, 0]],
        F=[[-1]],
        groups=GROUPS,
    )


def derivative(state: Floats, disturbance: Any, resistance: Any) -> Floats:
    """x' of the circuit, for states (..., 2)."""
    x1, x2 = state[..., 0], state[..., 1]
    diode = x1 * (DIODE[0] + DIODE[1] * x1 * x1)
    return np.stack([(x2 - diode) / CAPACITANCE_F, (disturbance - x1 - resistance * x2) / INDUCTANCE_H], axis=-1)
