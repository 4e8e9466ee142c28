"""Parameters that every node has."""

from node_kit.parameter import Parameter
from node_kit.parameter_table import ParameterTable

COMMON_PARAMETERS = ParameterTable(
    Parameter("frame_prefix", "", 'Prefix of all frame names, such as "robot1/" where several robots share tf.')
)
