"""Node map_server: a map from its files, for whoever needs it."""

import sys
from pathlib import Path
from typing import Any

from nav_msgs.msg import OccupancyGrid
from nav_msgs.srv import GetMap, LoadMap

from node_kit import Level, Parameter, ParameterTable, RejectedMessage, StackNode, qos, run
from node_kit.conversions import occupancy_grid_to_message
from tracked_localization.mapping.map_files import MapFileError, load_map
from tracked_localization.nodes.map_frame import MAP_FRAME
from tracked_types import OccupancyMap
from tracked_types.checked_yaml import CheckedFileError

MAP = Parameter("map", "", "path of the YAML of a map; empty: none until `load_map` is called")
_SCHEME = "file://"


class MapServerNode(StackNode):
    """Publishes map, latched; serves load_map, which replaces it, and get_map."""

    NAME = "map_server"
    PARAMETERS = ParameterTable(MAP, MAP_FRAME)

    def __init__(self) -> None:
        super().__init__()
        self.maps = self.publish_typed(OccupancyGrid, "map", occupancy_grid_to_message, qos.LATCHED)
        self.map: OccupancyMap | None = None
        self.serve(LoadMap, "load_map", self.on_load)
        self.serve(GetMap, "get_map", self.on_get)
        if self.value(MAP.name):
            self._load(self.value(MAP.name))
        else:
            self.diagnostics.report("map", Level.WARN, "no map yet: parameter map is empty")

    def on_load(self, request: Any, response: Any) -> Any:
        """Replace the map by that of a path or a file:// URL; on failure the old one stays."""
        try:
            response.map = self._load(request.map_url)
        except CheckedFileError as error:
            response.result = _kind(request.map_url, error)
            self.get_logger().error(f"load_map: {error}")
            self.diagnostics.report("map", Level.WARN, f"load_map failed: {error}")
        return response

    def on_get(self, _request: Any, response: Any) -> Any:
        """The map that is there."""
        if self.map is None:
            raise RejectedMessage("there is no map yet")
        response.map = self._message(self.map)
        return response

    def _load(self, url: str) -> OccupancyGrid:
        path = Path(url.removeprefix(_SCHEME))
        self.map = load_map(path, self.frame(self.value(MAP_FRAME.name)))
        message = self._message(self.map)
        self.maps.publisher.publish(message)
        height, width = self.map.occupancy.shape
        sentence = f"{path}: {width} x {height} cells of {self.map.resolution_m:g} m"
        self.get_logger().info(sentence)
        self.diagnostics.report("map", Level.OK, sentence)
        return message

    def _message(self, occupancy_map: OccupancyMap) -> OccupancyGrid:
        return occupancy_grid_to_message(occupancy_map, self.get_clock().now().nanoseconds)


def _kind(url: str, error: CheckedFileError) -> int:
    """The code of nav_msgs/LoadMap for what went wrong."""
    if not Path(url.removeprefix(_SCHEME)).is_file():
        return int(LoadMap.Response.RESULT_MAP_DOES_NOT_EXIST)
    if isinstance(error, MapFileError):
        return int(LoadMap.Response.RESULT_INVALID_MAP_DATA)
    return int(LoadMap.Response.RESULT_INVALID_MAP_METADATA)


def main() -> int:
    """Run the node; the exit code of the process."""
    return run(MapServerNode)


if __name__ == "__main__":
    sys.exit(main())
