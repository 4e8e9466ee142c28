"""Services whose handlers may fail without leaving the client waiting."""

from collections.abc import Callable
from typing import Any

from node_kit.failures import CallbackFailures, callback_name
from node_kit.rejection import RejectedMessage

Handler = Callable[[Any, Any], Any]
_OPERATION_FAILED = 4  # of the Result vocabulary of the ROS simulation interfaces


def refuse(response: Any, reason: str) -> Any:
    """Write a refusal into a response of the usual shapes: success and message, or result with error_message."""
    if hasattr(response, "success"):
        response.success = False
    if hasattr(response, "message"):
        response.message = reason
    result: Any = getattr(response, "result", None)
    if result is not None and hasattr(result, "error_message"):
        result.result, result.error_message = _OPERATION_FAILED, reason
    return response


def answering(handler: Handler, failures: CallbackFailures) -> Handler:
    """``handler`` with `RejectedMessage` and any other exception turned into a refusal with its reason."""

    def answer(request: Any, response: Any) -> Any:
        try:
            return handler(request, response)
        except RejectedMessage as rejection:
            return refuse(type(response)(), rejection.reason)
        except Exception as error:
            failures.note(callback_name(handler), error)
            return refuse(type(response)(), f"{type(error).__name__}: {error}")

    return answer
