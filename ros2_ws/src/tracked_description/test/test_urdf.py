import math
from xml.etree import ElementTree

import pytest

from tracked_description import load_robot, robot_urdf, suspension_joint_names
from tracked_description.fixed_frames import fixed_frames
from tracked_description.suspension import rest_travel_m

ROBOT = load_robot()


def parsed(**options):
    return ElementTree.fromstring(robot_urdf(ROBOT, **options))


def test_links_form_one_tree_with_the_contract_frames():
    root = parsed()
    links = {link.get("name") for link in root.iter("link")}
    parents = {joint.find("child").get("link"): joint.find("parent").get("link") for joint in root.iter("joint")}
    assert links - set(parents) == {"base_footprint"}
    assert set(parents) | set(parents.values()) == links
    assert parents["base_link"] == "base_footprint"
    assert parents["imu_link"] == parents["laser"] == parents["camera_link"] == "base_link"
    assert parents["camera_color_optical_frame"] == "camera_link"


def test_moving_joints_are_those_of_the_joint_states():
    moving = [joint.get("name") for joint in parsed().iter("joint") if joint.get("type") != "fixed"]
    assert moving == ["left_track", "right_track", *suspension_joint_names(ROBOT)]


def test_prefix_goes_before_every_link_and_no_joint():
    plain, prefixed = parsed(), parsed(frame_prefix="robot1/")
    assert [f"robot1/{link.get('name')}" for link in plain.iter("link")] == [
        link.get("name") for link in prefixed.iter("link")
    ]
    assert [joint.get("name") for joint in plain.iter("joint")] == [
        joint.get("name") for joint in prefixed.iter("joint")
    ]


def test_masses_add_up_and_every_inertia_is_that_of_a_body():
    root = parsed()
    masses = [float(element.get("value")) for element in root.iter("mass")]
    expected = ROBOT.chassis.sprung_mass_kg + 2 * ROBOT.tracks.wheel_count * ROBOT.chassis.unit_mass_kg
    assert sum(masses) == pytest.approx(expected)
    for inertia in root.iter("inertia"):
        moments = sorted(float(inertia.get(key)) for key in ("ixx", "iyy", "izz"))
        assert moments[0] > 0.0
        assert moments[0] + moments[1] >= moments[2] * (1.0 - 1e-9)


def test_wheels_touch_the_ground_where_the_suspension_rests():
    joint = next(joint for joint in parsed().iter("joint") if joint.get("name") == "left_suspension_1")
    height = float(joint.find("origin").get("xyz").split()[2]) + ROBOT.base_link_height_m
    rest = rest_travel_m(ROBOT, ROBOT.suspension.kind)
    axis = [float(value) for value in joint.find("axis").get("xyz").split()]
    assert height + axis[2] * rest == pytest.approx(ROBOT.tracks.wheel_radius_m)
    limit = joint.find("limit")
    assert float(limit.get("lower")) < rest < float(limit.get("upper"))


def test_optical_frame_looks_forward_with_x_to_the_right():
    roll, pitch, yaw = fixed_frames(ROBOT)[-1].rpy_rad
    assert (roll, pitch, yaw) == (-math.pi / 2, 0.0, -math.pi / 2)


def test_robot_that_its_suspension_cannot_carry_has_no_urdf():
    heavy = ROBOT.model_copy(update={"chassis": ROBOT.chassis.model_copy(update={"sprung_mass_kg": 500.0})})
    with pytest.raises(ValueError, match=r"load|compress"):
        robot_urdf(heavy)


def test_physics_engine_loads_the_urdf_and_moves_its_joints(tmp_path):
    pybullet = pytest.importorskip("pybullet", reason="the simulator's engine is not part of the robot's set")
    path = tmp_path / "robot.urdf"
    path.write_text(robot_urdf(ROBOT))
    client = pybullet.connect(pybullet.DIRECT)
    try:
        body = pybullet.loadURDF(str(path), physicsClientId=client, flags=pybullet.URDF_USE_INERTIA_FROM_FILE)
        infos = [
            pybullet.getJointInfo(body, index, physicsClientId=client)
            for index in range(pybullet.getNumJoints(body, physicsClientId=client))
        ]
        by_name = {info[1].decode(): info for info in infos}
        for name in ("left_track", *suspension_joint_names(ROBOT)):
            assert by_name[name][2] in (pybullet.JOINT_REVOLUTE, pybullet.JOINT_PRISMATIC)
        laser = by_name["laser_joint"][0]
        position = pybullet.getLinkState(body, laser, physicsClientId=client)[4]
        x, y, z = ROBOT.lidar.xyz_m
        assert position == pytest.approx((x, y, z + ROBOT.base_link_height_m), abs=1e-6)
        wheel = by_name["left_suspension_1"][0]
        mass = pybullet.getDynamicsInfo(body, wheel, physicsClientId=client)[0]
        assert mass == pytest.approx(ROBOT.chassis.unit_mass_kg)
    finally:
        pybullet.disconnect(client)
