"""tracked_interfaces/SafetyState."""

from tracked_interfaces.msg import SafetyState

from node_kit.conversions import fill_header
from tracked_safety.command_arbiter import ArbiterState, Mode

_CODES = {
    Mode.FORWARDING: SafetyState.FORWARDING,
    Mode.IDLE: SafetyState.IDLE,
    Mode.STOPPING: SafetyState.STOPPING,
    Mode.STOPPED: SafetyState.STOPPED,
    Mode.EMERGENCY_STOP: SafetyState.EMERGENCY_STOP,
}


def state_to_message(state: ArbiterState, into: SafetyState | None = None) -> SafetyState:
    """Message of the arbiter's state."""
    message = SafetyState() if into is None else into
    fill_header(message.header, state.stamp_ns, "")
    message.state, message.source, message.reason = _CODES[state.mode], state.source, state.reason
    return message
