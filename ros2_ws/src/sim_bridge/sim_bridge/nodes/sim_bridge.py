"""Node of the simulated robot: its topics, its services and the pace of simulated time."""

import time

from geometry_msgs.msg import Twist, TwistStamped

from node_kit import Level, Parameter, ParameterTable, RejectedMessage, StackNode, qos, run
from node_kit.conversions import command_from_message, twist_from_message
from sim_bridge.command_intake import CommandRefused
from sim_bridge.nodes.sensor_publishers import SensorPublishers
from sim_bridge.nodes.simulation_services import SimulationServices
from sim_bridge.pacing import LockStalled, Pacer, PacingSettings, RealTimeMeter
from sim_bridge.physics_settings import PhysicsSettings
from sim_bridge.run_control import RunControl
from sim_bridge.scene_settings import START_POSE, SceneSettings
from sim_bridge.simulator import Simulator, SimulatorSettings
from sim_bridge.vehicle import PhysicsDivergedError
from sim_bridge.world_control import WorldControl
from tracked_description import ROBOT_FILE, Robot, load_robot
from tracked_types import Twist2, VelocityCommand

PARAMETERS = ParameterTable.from_settings(
    PhysicsSettings,
    SimulatorSettings,
    PacingSettings,
    SceneSettings,
    extra=(
        Parameter(*ROBOT_FILE),
        Parameter(*START_POSE),
        Parameter("start_paused", False, "Whether time stands still until set_simulation_state lets it run."),
        Parameter("stamped_commands", True, "Whether cmd_vel is a TwistStamped, or a Twist that acts when it comes."),
    ),
)

LONG_WAIT_S = 1.0


class SimBridgeNode(StackNode):
    """Simulated robot in real time, as fast as possible, or in step with the commands that answer its odometry."""

    NAME = "sim_bridge"
    PARAMETERS = PARAMETERS

    def __init__(self) -> None:
        super().__init__()
        robot = self.prefixed(load_robot(self.value("robot_file")))
        scene = SceneSettings(start_pose=self.value("start_pose"), **self.tuning(SceneSettings))
        world, start = scene.load()
        physics = PhysicsSettings(**self.tuning(PhysicsSettings))
        self.simulator = Simulator(
            robot,
            world,
            SimulatorSettings(physics=physics, **self.tuning(SimulatorSettings)),
            seed=scene.seed,
            start=start,
        )
        # Before there are endpoints: who sees this node may expect its time to run.
        self.simulator.warm_up()
        self.meter = RealTimeMeter()
        self.pacer = Pacer(PacingSettings.from_robot(robot, **self.tuning(PacingSettings)))
        self.simulation = RunControl(self.simulator, self.pacer, SensorPublishers(self, robot).publish)
        self.simulation.set_paused(self.value("start_paused"))
        SimulationServices(self, self.simulation, WorldControl(self.simulator))
        if self.value("stamped_commands"):
            self.subscribe_typed(TwistStamped, "cmd_vel", command_from_message, self.on_command, qos.COMMAND)
        else:
            self.subscribe_typed(Twist, "cmd_vel", twist_from_message, self.on_twist, qos.COMMAND)
        self.diagnostics.add_source(self.report)

    def prefixed(self, robot: Robot) -> Robot:
        """The robot with the prefix before its frame names."""
        frames = robot.frames.model_copy(update={field: self.frame(name) for field, name in robot.frames})
        return robot.model_copy(update={"frames": frames})

    def on_command(self, command: VelocityCommand) -> None:
        """Hand a command to the simulator; node_kit counts refusals with their sender."""
        try:
            self.simulator.submit(command)
        except CommandRefused as refusal:
            raise RejectedMessage(refusal.reason) from refusal

    def on_twist(self, twist: Twist2) -> None:
        """Take an unstamped command as answering the present instant."""
        self.on_command(VelocityCommand(self.simulator.stamp_ns, twist))

    def idle_work(self) -> float:
        """Run one tick if it is due; commands are taken between ticks."""
        try:
            return self.simulation.work(time.monotonic())
        except (LockStalled, PhysicsDivergedError) as error:
            self.request_exit(1, str(error))
            return 0.0

    def report(self) -> None:
        """Say how the simulation goes."""
        simulator = self.simulator
        now_s = time.monotonic()
        factor = self.meter.update(simulator.stamp_ns, now_s)
        faults = simulator.sensors.active_faults(simulator.stamp_ns)
        level, message = Level.OK, "running"
        if self.simulation.paused:
            message = "paused"
        elif self.pacer.waited_s(now_s) > LONG_WAIT_S:
            level, message = Level.WARN, "lock-step: waiting for a command"
        elif simulator.intake.timed_out(simulator.stamp_ns):
            level, message = Level.WARN, "commands have ceased: standing still"
        elif faults:
            level, message = Level.WARN, "faults are injected"
        values = {
            "simulated time (s)": simulator.stamp_ns * 1e-9,
            "real-time factor": factor,
            "world": simulator.world.name,
            "injected faults": ", ".join(f"{fault.sensor} {fault.kind}" for fault in faults) or "none",
            **{f"commands refused: {reason}": count for reason, count in sorted(simulator.intake.refused.items())},
        }
        self.diagnostics.report("simulation", level, message, values)

    def safe_stop(self) -> None:
        """Nothing moves on without this process; free the world."""
        self.simulator.close()


def main() -> int:
    """Run the node; returns the exit code."""
    return run(SimBridgeNode)
