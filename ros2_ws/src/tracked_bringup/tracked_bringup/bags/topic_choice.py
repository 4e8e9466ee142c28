"""Which topics are meant: names or regular expressions, and exceptions from them."""

import re
from collections.abc import Iterable


class TopicChoice:
    """Topics whose whole name matches one of ``wanted`` and none of ``unwanted``; empty texts are left out.

    Each text is a name or a regular expression. One that does not begin with a slash stands below ``namespace``.

    Raises
    ------
    ValueError: a text is no regular expression, or nothing is wanted.
    """

    def __init__(self, wanted: Iterable[str], unwanted: Iterable[str] = (), namespace: str = "/") -> None:
        self._wanted = _patterns(wanted, namespace)
        self._unwanted = _patterns(unwanted, namespace)
        if not self._wanted:
            raise ValueError("no topic is named")

    def __contains__(self, topic: str) -> bool:
        return any(pattern.fullmatch(topic) for pattern in self._wanted) and not any(
            pattern.fullmatch(topic) for pattern in self._unwanted
        )

    def __str__(self) -> str:
        text = " or ".join(pattern.pattern for pattern in self._wanted)
        return text + (f" but not {' or '.join(p.pattern for p in self._unwanted)}" if self._unwanted else "")


def _patterns(texts: Iterable[str], namespace: str) -> list[re.Pattern[str]]:
    patterns = []
    for text in filter(None, texts):
        try:
            # By itself first: what stands below a namespace must not repair it.
            re.compile(text)
            patterns.append(re.compile(text if text.startswith("/") else f"{namespace.rstrip('/')}/{text}"))
        except re.error as error:
            raise ValueError(f"{text!r} is neither a topic nor a regular expression ({error})") from error
    return patterns
