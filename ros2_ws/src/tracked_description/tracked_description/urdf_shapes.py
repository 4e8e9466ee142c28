"""Elements of a URDF."""

import math
from dataclasses import dataclass
from xml.etree import ElementTree

Vector = tuple[float, float, float]
_ORIGIN: Vector = (0.0, 0.0, 0.0)
_AXIS_ALONG_Y: Vector = (0.5 * math.pi, 0.0, 0.0)


@dataclass(frozen=True, slots=True)
class Inertia:
    """Principal moments (kg m^2) about the centre of mass."""

    xx: float
    yy: float
    zz: float


def box_inertia(mass_kg: float, size_m: Vector) -> Inertia:
    """Moments of a solid box."""
    x, y, z = (edge * edge for edge in size_m)
    return Inertia(mass_kg * (y + z) / 12.0, mass_kg * (x + z) / 12.0, mass_kg * (x + y) / 12.0)


def cylinder_inertia(mass_kg: float, radius_m: float, width_m: float) -> Inertia:
    """Moments of a solid cylinder whose axis is y, as a wheel's."""
    across = mass_kg * (3.0 * radius_m**2 + width_m**2) / 12.0
    return Inertia(across, 0.5 * mass_kg * radius_m**2, across)


def sub_element(parent: ElementTree.Element, tag: str, **attributes: str) -> ElementTree.Element:
    """A new child of ``parent``."""
    return ElementTree.SubElement(parent, tag, attributes)


def add_inertial(link: ElementTree.Element, mass_kg: float, inertia: Inertia, centre_m: Vector = _ORIGIN) -> None:
    """Mass and inertia of a link."""
    inertial = sub_element(link, "inertial")
    sub_element(inertial, "origin", xyz=_text(centre_m), rpy=_text(_ORIGIN))
    sub_element(inertial, "mass", value=_number(mass_kg))
    sub_element(
        inertial,
        "inertia",
        ixx=_number(inertia.xx),
        iyy=_number(inertia.yy),
        izz=_number(inertia.zz),
        ixy="0",
        ixz="0",
        iyz="0",
    )


def add_box(
    link: ElementTree.Element,
    size_m: Vector,
    centre_m: Vector = _ORIGIN,
    *,
    material: str,
    rpy: Vector = _ORIGIN,
    collides: bool = False,
) -> None:
    """A box that is seen and, if wanted, touched."""
    for tag in ("visual", "collision") if collides else ("visual",):
        element = sub_element(link, tag)
        sub_element(element, "origin", xyz=_text(centre_m), rpy=_text(rpy))
        sub_element(sub_element(element, "geometry"), "box", size=_text(size_m))
        if tag == "visual":
            sub_element(element, "material", name=material)


def add_cylinder(
    link: ElementTree.Element, radius_m: float, width_m: float, *, material: str, collides: bool = False
) -> None:
    """A wheel: a cylinder whose axis is y."""
    for tag in ("visual", "collision") if collides else ("visual",):
        element = sub_element(link, tag)
        sub_element(element, "origin", xyz=_text(_ORIGIN), rpy=_text(_AXIS_ALONG_Y))
        cylinder = sub_element(element, "geometry")
        sub_element(cylinder, "cylinder", radius=_number(radius_m), length=_number(width_m))
        if tag == "visual":
            sub_element(element, "material", name=material)


def add_joint(
    root: ElementTree.Element,
    name: str,
    kind: str,
    parent: str,
    child: str,
    xyz_m: Vector,
    rpy_rad: Vector = _ORIGIN,
    *,
    axis: Vector | None = None,
) -> ElementTree.Element:
    """A joint between two links; moving ones need an ``axis``."""
    joint = sub_element(root, "joint", name=name, type=kind)
    sub_element(joint, "parent", link=parent)
    sub_element(joint, "child", link=child)
    sub_element(joint, "origin", xyz=_text(xyz_m), rpy=_text(rpy_rad))
    if axis is not None:
        sub_element(joint, "axis", xyz=_text(axis))
    return joint


def _number(value: float) -> str:
    return f"{value:.12g}"


def _text(vector: Vector) -> str:
    return " ".join(_number(value) for value in vector)
