"""One process of nodes: start, spin, signals, safe stop and exit code."""

import os
import sys
import time
import traceback
from collections.abc import Sequence
from typing import Any

import rclpy
from rclpy.duration import Duration
from rclpy.logging import get_logger
from rclpy.qos import ReliabilityPolicy
from rclpy.signals import SignalHandlerOptions
from rclpy.utilities import remove_ros_args

from node_kit.docs import render_nodes
from node_kit.executors import executor_kind, make_executor
from node_kit.failures import callback_name, debugging
from node_kit.node import StackNode
from node_kit.stop_signals import StopSignals, StopWhileStarting

OK, FAILED, BAD_PARAMETERS = 0, 1, 2
_LONGEST_WAIT_S = 0.1
_FLUSH_LIMIT_S = 0.3


def run(*node_classes: type[StackNode], args: Sequence[str] | None = None) -> int:
    """Host the nodes in this process until SIGINT, SIGTERM or an exit that a node requests; returns the exit code.

    0: stopped by a signal or by a node; 1: a node failed or could not start; 2: bad arguments or parameters.
    Every node's `StackNode.safe_stop` runs before anything is destroyed. The environment variable NODE_KIT_EXECUTOR
    chooses the executor: ``events`` (default) or ``single``.
    """
    arguments = list(sys.argv if args is None else args)
    name = " ".join(node_class.NAME for node_class in node_classes)
    try:
        own, kind = remove_ros_args(arguments)[1:], executor_kind()
    except (RuntimeError, ValueError) as error:
        return _refuse(name, " ".join(str(error).split()))
    if own in (["--help"], ["-h"]):
        print(render_nodes(node_classes), end="")
        return OK
    if own:
        return _refuse(name, f"unknown argument {own[0]}; parameters are given as --ros-args -p name:=value")
    stop = StopSignals()
    nodes: list[StackNode] = []
    with stop.handled():
        try:
            code = _serve(node_classes, nodes, arguments, kind, stop)
        except StopWhileStarting:
            code = OK
        except Exception:
            traceback.print_exc()
            code = FAILED
        stop.ignore()
        _finish(nodes)
    return code


def _refuse(name: str, sentence: str) -> int:
    print(f"{name}: {sentence}", file=sys.stderr)
    return BAD_PARAMETERS


def _serve(
    node_classes: Sequence[type[StackNode]],
    nodes: list[StackNode],
    arguments: list[str],
    kind: str,
    stop: StopSignals,
) -> int:
    """Make the nodes, which ``nodes`` then holds, and spin them."""
    try:
        rclpy.init(args=arguments, signal_handler_options=SignalHandlerOptions.NO)
    except Exception as error:
        return _refuse(" ".join(node_class.NAME for node_class in node_classes), " ".join(str(error).split()))
    executor = make_executor(kind)
    code = _start(node_classes, nodes, executor)
    stop.started()
    return _spin(executor, nodes, stop) if code == OK else code


def _start(node_classes: Sequence[type[StackNode]], nodes: list[StackNode], executor: Any) -> int:
    """Make every node; on failure say why in one line."""
    for node_class in node_classes:
        try:
            node = node_class()
        except Exception as error:
            if debugging():
                traceback.print_exc()
            get_logger(node_class.NAME).fatal(f"cannot start: {_explain(error)}")
            return _exit_code(error)
        nodes.append(node)
        executor.add_node(node)
    return OK


def _exit_code(error: Exception) -> int:
    """A setting that its class refuses is a bad parameter; a file that cannot be used is not."""
    from tracked_types.checked_yaml import CheckedFileError  # slow to import, and seldom needed

    is_setting = isinstance(error, ValueError) and not isinstance(error, CheckedFileError)
    return BAD_PARAMETERS if is_setting else FAILED


def _explain(error: Exception) -> str:
    """One line; errors that are not written for users say where they come from."""
    text = " ".join(str(error).split())
    if isinstance(error, ValueError | OSError):
        return text
    place = traceback.extract_tb(error.__traceback__)[-1]
    where = f"{os.path.basename(place.filename)}:{place.lineno}"
    return f"{type(error).__name__}: {text} ({where}; NODE_KIT_DEBUG=1 says more)"


def _spin(executor: Any, nodes: Sequence[StackNode], stop: StopSignals) -> int:
    """Serve until a stop is requested.

    The events executor is driven one callback at a time, since its own loop does not return on shutdown.
    """
    workers = [node for node in nodes if type(node).idle_work is not StackNode.idle_work]
    while rclpy.ok() and not stop.requested:
        wait_s = min([_LONGEST_WAIT_S, *map(_idle, workers)])
        try:
            executor.spin_once(timeout_sec=max(0.0, wait_s))
        except Exception as error:
            if not rclpy.ok():  # the context went away between two waits
                break
            # Callbacks made by `StackNode` never get here; those of rclpy itself can.
            nodes[0].note_failure("spin", error)
        for node in nodes:
            if node.exit_code is not None:
                return node.exit_code
    return OK


def _idle(worker: StackNode) -> float:
    """Let a node do its idle work; how long it can wait for the next."""
    try:
        return worker.idle_work()
    except Exception as error:
        worker.note_failure(callback_name(worker.idle_work), error)
        return _LONGEST_WAIT_S


def _finish(nodes: Sequence[StackNode]) -> None:
    """Stop what moves, let the last messages leave, then take everything down; nothing here may raise."""
    for node in nodes:
        _attempt(node.safe_stop)
    deadline_s = time.monotonic() + _FLUSH_LIMIT_S
    for node in nodes:
        for typed in node.typed_publishers:
            if typed.publisher.qos_profile.reliability == ReliabilityPolicy.RELIABLE:
                rest_s = max(0.0, deadline_s - time.monotonic())
                _attempt(
                    lambda publisher=typed.publisher, rest_s=rest_s: publisher.wait_for_all_acked(
                        Duration(seconds=rest_s)
                    )
                )
    for node in nodes:
        _attempt(node.destroy_node)
    _attempt(rclpy.try_shutdown)


def _attempt(step: Any) -> None:
    try:
        step()
    except Exception:
        if rclpy.ok():
            traceback.print_exc()
