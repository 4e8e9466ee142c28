"""Theorem 3.2: inequalities for a filter that meets an extended dissipative index, of full or reduced order.

The change of variables makes the error system's Lyapunov matrix P = [R, HL; LH', L] with H selecting as many states as
the filter has (the identity for full order), and A_f = L^-1 A, B_f = L^-1 B, C_f = C from the unknowns A, B, C.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from robust_core.filtering.index import DissipativeIndex
from robust_core.lmi import Constraint, Unknown, Unknowns, he
from robust_core.lmi.constraint import blocks, transpose
from robust_core.lmi.unknowns import Values
from robust_core.rational import Floats


@dataclass(frozen=True, slots=True)
class Synthesis:
    """The problem in floats: data of the plant, factors of the index, order of the filter, region of the poles.

    ``region``: matrices (L, M) of an LMI region {s: L + s M + conj(s) M' < 0} for the poles of the filtering error.
    ``fastest_pole``: bound on the modulus of the filter's poles, which keeps unattained optima from blowing gains up.
    """

    data: Any
    index: DissipativeIndex
    order: int
    regions: Sequence[tuple[Floats, Floats]] = ()
    fastest_pole: float | None = None

    @property
    def unknowns(self) -> Unknowns:
        """R, L, A, B, C and the level."""
        n, z, y = self.data["A"].shape[-1], self.data["C"].shape[-2], self.data["E"].shape[-2]
        return Unknowns(
            (
                Unknown("R", n, symmetric=True),
                Unknown("L", self.order, symmetric=True),
                Unknown("A", self.order),
                Unknown("B", self.order, y),
                Unknown("C", z, self.order),
                Unknown("level", 1),
            )
        )

    def lyapunov(self, values: Values) -> Any:
        """P of the error system, (..., n + order, n + order)."""
        coupling = self._embed(values["L"])
        return blocks([[values["R"], coupling], [transpose(coupling), values["L"]]])

    def constraints(self, values: Values) -> list[Constraint]:
        """(3.2.21)-(3.2.24); the unknown G of the theorem is eliminated, which loses nothing."""
        P = self.lyapunov(values)
        flow = self._flow(values)
        found = [
            Constraint("P > 0", P[..., None, :, :]),
            Constraint("dissipation (3.2.22)", self._dissipation(flow, values)),
        ]
        phi_root = _root(self.index.matrices(exact=False)[0])
        if phi_root.any():
            output = phi_root @ self._output(values)
            unit = np.eye(output.shape[-2])
            stacked = blocks([[P[..., None, :, :], transpose(output)], [output, _constant(unit, output)]])
            found.append(Constraint("peak (3.2.21), (3.2.23)", stacked))
        for number, (offset, slope) in enumerate(self.regions):
            form = _kron(offset, P[..., None, :, :]) + _kron(slope, flow) + _kron(slope.T, transpose(flow))
            found.append(Constraint(f"poles {number} (3.2.24)", -form))
        if self.fastest_pole is not None:
            bound = self.fastest_pole
            A, L = values["A"], values["L"]
            speed = blocks([[bound * L, transpose(A)], [A, bound * L]])
            found.append(Constraint("fastest pole of the filter", speed[..., None, :, :]))
        return found

    def _embed(self, matrix: Any) -> Any:
        """H times a matrix (..., order, k): zero rows below it."""
        n = self.data["A"].shape[-1]
        lead = np.zeros((*matrix.shape[:-2], n, matrix.shape[-1]))
        lead[..., : self.order, :] = matrix
        return lead

    def _flow(self, values: Values) -> Any:
        """P times the error system's state matrix, (..., m, N, N): W_i of (3.2.24) without its shift."""
        d = self.data
        R, L, A, B = (values[name][..., None, :, :] for name in ("R", "L", "A", "B"))
        measured, turned = B @ d["E"], L @ d["A"][:, : self.order, :]
        rows = [[R @ d["A"] + self._embed(measured), self._embed(A)], [turned + measured, A]]
        return blocks(rows)

    def _output(self, values: Values) -> Any:
        """The error's output matrix [C_i, -C_f]: constant on the left, unknown on the right."""
        return blocks([[_constant(self.data["C"], values["C"]), -values["C"][..., None, :, :]]])

    def _dissipation(self, flow: Any, values: Values) -> Any:
        d, index = self.data, self.index
        R, L, B, C, level = (values[name][..., None, :, :] for name in ("R", "L", "B", "C", "level"))
        _, psi1, psi2, psi3 = index.matrices(exact=False)
        root = _root(-psi1)
        measured = B @ d["F"]
        drive = blocks(
            [
                [R @ d["B"] + self._embed(measured) - transpose(d["C"]) @ psi2 * _one(R)],
                [L @ d["B"][:, : self.order, :] + measured + transpose(C) @ psi2],
            ]
        )
        supply = -he(transpose(d["D"]) @ psi2) - psi3 - level * np.eye(psi3.shape[0])
        if not root.any():
            return -blocks([[he(flow), drive], [transpose(drive), supply]])
        output, through = transpose(root @ self._output(values)), _constant(transpose(root @ d["D"]), level)
        unit = _constant(-np.eye(root.shape[0]), level)
        return -blocks(
            [
                [he(flow), drive, output],
                [transpose(drive), supply, through],
                [transpose(output), transpose(through), unit],
            ]
        )


def _one(like: Any) -> Any:
    return np.ones((*like.shape[:-2], 1, 1))


def _constant(matrix: Floats, like: Any) -> Any:
    """A constant stack with the leading axes of ``like``, so that blocks broadcast."""
    lead = np.broadcast_shapes(like.shape[:-3] if like.ndim > 2 else (), matrix.shape[:-3])
    return np.broadcast_to(matrix, (*lead, *matrix.shape[-3:])) if matrix.ndim > 2 else matrix


def _kron(left: Floats, right: Any) -> Any:
    rows, size = left.shape[0], right.shape[-1]
    product = left[:, None, :, None] * right[..., None, :, None, :]
    return product.reshape(*right.shape[:-2], rows * size, rows * size)


def _root(matrix: Floats) -> Floats:
    """F with F'F = matrix for a positive semidefinite one; rows that vanish are left out."""
    values, vectors = np.linalg.eigh(matrix)
    keep = values > 1e-14 * max(values.max(initial=0.0), 1e-300)
    root: Floats = np.sqrt(values[keep])[:, None] * vectors[:, keep].T
    return root if root.size else np.zeros((1, matrix.shape[0]))
