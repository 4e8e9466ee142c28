"""tracked_interfaces/SafetyState."""

import math

from tracked_interfaces.msg import SafetyState

from node_kit.conversions.headers import fill_header, stamp_from_message
from node_kit.rejection import RejectedMessage
from tracked_types import ArbiterMode, ArbiterState, GuardAction

_CODES = {mode: getattr(SafetyState, mode.name) for mode in ArbiterMode}
_MODES = {code: mode for mode, code in _CODES.items()}
_GUARD_CODES = {action: getattr(SafetyState, f"GUARD_{action.name}") for action in GuardAction}
_GUARD_ACTIONS = {code: action for action, code in _GUARD_CODES.items()}


def safety_state_from_message(message: SafetyState) -> ArbiterState:
    """State of the command arbiter."""
    mode, guard = _MODES.get(message.state), _GUARD_ACTIONS.get(message.guard)
    if mode is None:
        raise RejectedMessage(f"unknown state: {message.state}")
    if guard is None:
        raise RejectedMessage(f"unknown guard: {message.guard}")
    if math.isnan(message.obstacle_m):
        raise RejectedMessage("not a number: obstacle_m")
    stamp_ns = stamp_from_message(message.header.stamp)
    return ArbiterState(stamp_ns, mode, message.source, message.reason, guard, message.guard_reason, message.obstacle_m)


def safety_state_to_message(state: ArbiterState, into: SafetyState | None = None) -> SafetyState:
    """Message of the arbiter's state."""
    message = SafetyState() if into is None else into
    fill_header(message.header, state.stamp_ns, "")
    message.state, message.source, message.reason = _CODES[state.mode], state.source, state.reason
    message.guard, message.guard_reason = _GUARD_CODES[state.guard], state.guard_reason
    message.obstacle_m = float(state.obstacle_m)
    return message
