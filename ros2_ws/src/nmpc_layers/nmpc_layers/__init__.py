"""Double-layer nonlinear model predictive control of a slipping tracked robot (thesis 5.2)."""

from nmpc_layers.goal_approach import Phase
from nmpc_layers.layer_weights import LayerWeights, load_weights
from nmpc_layers.lower_layer import LowerLayer, LowerOutput
from nmpc_layers.lower_settings import LowerSettings
from nmpc_layers.upper_layer import UpperLayer, UpperOutput
from nmpc_layers.upper_settings import UpperSettings

__all__ = [
    "LayerWeights",
    "LowerLayer",
    "LowerOutput",
    "LowerSettings",
    "Phase",
    "UpperLayer",
    "UpperOutput",
    "UpperSettings",
    "load_weights",
]
