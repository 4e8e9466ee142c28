"""Certificates: proofs that are checked without a solver, in floating point or in exact arithmetic."""

from robust_core.certificates.certificate import Certificate, Margins
from robust_core.certificates.files import load_certificate, save_certificate

__all__ = ["Certificate", "Margins", "load_certificate", "save_certificate"]
