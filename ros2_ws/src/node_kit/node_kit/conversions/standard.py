"""std_msgs."""

from std_msgs.msg import Bool, String


def bool_from_message(message: Bool) -> bool:
    """Value of a std_msgs/Bool."""
    return bool(message.data)


def bool_to_message(value: bool, into: Bool | None = None) -> Bool:
    """Message of a truth value."""
    message = Bool() if into is None else into
    message.data = bool(value)
    return message


def string_from_message(message: String) -> str:
    """Text of a std_msgs/String."""
    return str(message.data)


def string_to_message(text: str, into: String | None = None) -> String:
    """Message of a text."""
    message = String() if into is None else into
    message.data = text
    return message
