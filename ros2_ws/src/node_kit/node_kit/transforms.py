"""Transforms on the topics tf and tf_static."""

from geometry_msgs.msg import TransformStamped
from rclpy.clock import JumpThreshold, TimeJump
from rclpy.duration import Duration
from rclpy.node import Node
from rclpy.publisher import Publisher
from rclpy.qos import DurabilityPolicy, QoSProfile, ReliabilityPolicy
from tf2_msgs.msg import TFMessage

from node_kit.conversions.transform import fill_transform, transforms_from_message
from node_kit.node import StackNode
from node_kit.qos import STATE
from node_kit.rigid_transform import RigidTransform, StampedTransform
from node_kit.transform_buffer import TransformBuffer

_STATIC = QoSProfile(depth=100, reliability=ReliabilityPolicy.RELIABLE, durability=DurabilityPolicy.TRANSIENT_LOCAL)
_STATIC_SENDER = QoSProfile(
    depth=1, reliability=ReliabilityPolicy.RELIABLE, durability=DurabilityPolicy.TRANSIENT_LOCAL
)


class TransformBroadcaster:
    """Sends transforms; frame names are complete, prefix included (`StackNode.frame`)."""

    def __init__(self, node: Node) -> None:
        self._node = node
        self._message = TFMessage(transforms=[TransformStamped()])
        self._publisher: Publisher | None = None
        self._static_publisher: Publisher | None = None
        self._static: dict[str, StampedTransform] = {}

    def advertise(self) -> None:
        """Publish on tf from now on; a node that only sends fixed transforms is no publisher of it."""
        if self._publisher is None:
            self._publisher = self._node.create_publisher(TFMessage, "tf", STATE)

    def send(
        self,
        parent: str,
        child: str,
        x: float,
        y: float,
        z: float,
        roll: float,
        pitch: float,
        yaw: float,
        stamp_ns: int,
    ) -> None:
        """Send the pose of ``child`` in ``parent`` (m, rad) at ``stamp_ns``; `advertise` first, to be heard at once."""
        self.advertise()
        assert self._publisher is not None
        transform = RigidTransform.from_euler(x, y, z, roll, pitch, yaw)
        fill_transform(self._message.transforms[0], StampedTransform(stamp_ns, parent, child, transform))
        self._publisher.publish(self._message)

    def send_static(
        self,
        parent: str,
        child: str,
        x: float,
        y: float,
        z: float,
        roll: float,
        pitch: float,
        yaw: float,
        stamp_ns: int = 0,
    ) -> None:
        """Send the pose of ``child`` in ``parent`` (m, rad) for all time, together with those sent before."""
        if self._static_publisher is None:
            self._static_publisher = self._node.create_publisher(TFMessage, "tf_static", _STATIC_SENDER)
        transform = RigidTransform.from_euler(x, y, z, roll, pitch, yaw)
        self._static[child] = StampedTransform(stamp_ns, parent, child, transform)
        message = TFMessage(transforms=[TransformStamped() for _ in self._static])
        for target, stamped in zip(message.transforms, self._static.values(), strict=True):
            fill_transform(target, stamped)
        self._static_publisher.publish(message)


class TransformListener:
    """Feeds a buffer from tf and tf_static; forgets moving transforms when the node's clock jumps back."""

    def __init__(self, node: StackNode, buffer: TransformBuffer | None = None) -> None:
        self.buffer = TransformBuffer() if buffer is None else buffer
        node.subscribe_typed(TFMessage, "tf", transforms_from_message, self._on_moving, STATE)
        node.subscribe_typed(TFMessage, "tf_static", transforms_from_message, self._on_static, _STATIC)
        threshold = JumpThreshold(min_forward=None, min_backward=Duration(nanoseconds=-1), on_clock_change=True)
        self._jump = node.get_clock().create_jump_callback(threshold, post_callback=self._on_jump)

    def _on_moving(self, transforms: list[StampedTransform]) -> None:
        for stamped in transforms:
            self.buffer.add(stamped.parent, stamped.child, stamped.transform, stamped.stamp_ns)

    def _on_static(self, transforms: list[StampedTransform]) -> None:
        for stamped in transforms:
            self.buffer.add_static(stamped.parent, stamped.child, stamped.transform)

    def _on_jump(self, _: TimeJump) -> None:
        self.buffer.clear_moving()
