"""tracked_interfaces/SafetyState."""

from tracked_interfaces.msg import SafetyState

from node_kit.conversions.headers import fill_header, stamp_from_message
from node_kit.rejection import RejectedMessage
from tracked_types import ArbiterMode, ArbiterState

_CODES = {mode: getattr(SafetyState, mode.name) for mode in ArbiterMode}
_MODES = {code: mode for mode, code in _CODES.items()}


def safety_state_from_message(message: SafetyState) -> ArbiterState:
    """State of the command arbiter."""
    mode = _MODES.get(message.state)
    if mode is None:
        raise RejectedMessage(f"unknown state: {message.state}")
    return ArbiterState(stamp_from_message(message.header.stamp), mode, message.source, message.reason)


def safety_state_to_message(state: ArbiterState, into: SafetyState | None = None) -> SafetyState:
    """Message of the arbiter's state."""
    message = SafetyState() if into is None else into
    fill_header(message.header, state.stamp_ns, "")
    message.state, message.source, message.reason = _CODES[state.mode], state.source, state.reason
    return message
