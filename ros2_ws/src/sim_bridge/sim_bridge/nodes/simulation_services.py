"""Services of the simulation, in the vocabulary of the ROS simulation interfaces."""

from collections.abc import Callable
from typing import Any

from geometry_msgs.msg import Pose
from tracked_interfaces.msg import EntityState as EntityStateMessage
from tracked_interfaces.msg import Result
from tracked_interfaces.srv import (
    DeleteEntity,
    GetEntities,
    GetEntityState,
    GetSimulationState,
    GetSimulatorFeatures,
    InjectFault,
    ResetSimulation,
    SetEntityState,
    SetFriction,
    SetSimulationState,
    SetSuspension,
    SpawnEntity,
    StepSimulation,
)

from node_kit import StackNode
from node_kit.conversions import fill_header, stamp_from_message
from node_kit.conversions.geometry import fill_quaternion, fill_vector, quaternion_from_message, vector_from_message
from node_kit.rotations import quaternion_from_roll_pitch_yaw, roll_pitch_yaw_from_quaternion
from sim_bridge.entities import EntityState
from sim_bridge.nodes.sensor_publishers import WORLD_FRAME
from sim_bridge.pacing import TIME_MODES
from sim_bridge.run_control import RunControl, WrongStateError
from sim_bridge.world_control import UnknownNameError, WorldControl

Vector = tuple[float, float, float]


class SimulationServices:
    """Serves run control (pause, step, reset), the world's bodies and surfaces, and faults.

    Every response carries a result: OK, or NOT_FOUND, INCORRECT_STATE or OPERATION_FAILED with the reason.
    """

    def __init__(self, node: StackNode, run: RunControl, world: WorldControl) -> None:
        self._node = node
        self._run = run
        self._world = world
        self._served: dict[str, Any] = {}
        self._serve("get_simulator_features", GetSimulatorFeatures, self._features)
        self._serve("get_simulation_state", GetSimulationState, self._get_state)
        self._serve("set_simulation_state", SetSimulationState, self._set_state)
        self._serve("step_simulation", StepSimulation, lambda request, _: run.step(request.steps))
        self._serve("reset_simulation", ResetSimulation, lambda request, _: run.reset(request.seed))
        self._serve("inject_fault", InjectFault, self._inject_fault)
        self._serve("get_entities", GetEntities, self._entities)
        self._serve("get_entity_state", GetEntityState, self._get_entity_state)
        self._serve("set_entity_state", SetEntityState, self._set_entity_state)
        self._serve("spawn_entity", SpawnEntity, self._spawn)
        self._serve("delete_entity", DeleteEntity, lambda request, _: world.delete(request.entity))
        self._serve(
            "set_friction",
            SetFriction,
            lambda request, _: world.set_friction(
                request.zone, request.friction_longitudinal, request.friction_lateral
            ),
        )
        self._serve("set_suspension", SetSuspension, lambda request, _: world.set_suspension(request.kind))

    def _serve(self, name: str, service_type: Any, act: Callable[[Any, Any], None]) -> None:
        """``act(request, response)`` fills the response or raises; the result is written here."""

        def handle(request: Any, response: Any) -> Any:
            try:
                act(request, response)
            except UnknownNameError as error:
                return _refused(service_type, Result.NOT_FOUND, error)
            except WrongStateError as error:
                return _refused(service_type, Result.INCORRECT_STATE, error)
            except ValueError as error:
                return _refused(service_type, Result.OPERATION_FAILED, error)
            response.result.result = Result.OK
            return response

        self._served[name] = self._node.serve(service_type, name, handle)

    def _features(self, _request: Any, response: Any) -> None:
        response.features = [*self._served, *(f"time_mode {mode}" for mode in TIME_MODES)]

    def _get_state(self, _request: Any, response: Any) -> None:
        states = GetSimulationState.Request
        response.state = states.PAUSED if self._run.paused else states.PLAYING

    def _set_state(self, request: Any, _response: Any) -> None:
        states = SetSimulationState.Request
        if request.state not in (states.PLAYING, states.PAUSED):
            raise ValueError(f"state must be {states.PLAYING} (playing) or {states.PAUSED} (paused)")
        self._run.set_paused(request.state == states.PAUSED)

    def _inject_fault(self, request: Any, _response: Any) -> None:
        if request.kind:
            start_ns = stamp_from_message(request.start)
            self._run.inject_fault(request.sensor, request.kind, request.duration, request.magnitude, start_ns)
        else:
            self._run.end_faults(request.sensor)

    def _entities(self, _request: Any, response: Any) -> None:
        response.entities = list(self._world.entity_names)

    def _get_entity_state(self, request: Any, response: Any) -> None:
        state = self._world.entity_state(request.entity)
        message: EntityStateMessage = response.state
        fill_header(message.header, self._run.stamp_ns, self._node.frame(WORLD_FRAME))
        fill_vector(message.pose.position, *state.position_m)
        fill_quaternion(message.pose.orientation, quaternion_from_roll_pitch_yaw(*state.roll_pitch_yaw_rad))
        fill_vector(message.twist.linear, *state.velocity_mps)
        fill_vector(message.twist.angular, *state.angular_velocity_radps)

    def _set_entity_state(self, request: Any, _response: Any) -> None:
        position, roll_pitch_yaw = _pose(request.state.pose)
        twist = request.state.twist
        state = EntityState(
            position,
            roll_pitch_yaw,
            vector_from_message("linear", twist.linear),
            vector_from_message("angular", twist.angular),
        )
        self._world.set_entity_state(request.entity, state)

    def _spawn(self, request: Any, _response: Any) -> None:
        position, roll_pitch_yaw = _pose(request.initial_pose)
        entity = request.entity
        x, y, z = entity.size.tolist()
        self._world.spawn(entity.name, entity.shape, (x, y, z), entity.mass, position, roll_pitch_yaw)


def _pose(pose: Pose) -> tuple[Vector, Vector]:
    position = vector_from_message("position", pose.position)
    quaternion = quaternion_from_message("orientation", pose.orientation)
    return position, roll_pitch_yaw_from_quaternion(*quaternion)


def _refused(service_type: Any, code: int, error: Exception) -> Any:
    response = service_type.Response()
    response.result.result, response.result.error_message = code, str(error)
    return response
