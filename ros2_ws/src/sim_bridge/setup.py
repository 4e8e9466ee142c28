from setuptools import find_packages, setup

NAME = "sim_bridge"

setup(
    name=NAME,
    version="0.1.0",
    packages=find_packages(exclude=["test"]),
    package_data={NAME: ["py.typed", "worlds/*.yaml"]},
    data_files=[
        ("share/ament_index/resource_index/packages", [f"resource/{NAME}"]),
        (f"share/{NAME}", ["package.xml"]),
    ],
    install_requires=["setuptools", "numba", "numpy", "pybullet", "pydantic>=2", "PyYAML"],
    entry_points={"console_scripts": ["sim_bridge = sim_bridge.nodes.sim_bridge:main"]},
    zip_safe=False,
    maintainer="Tracked Stack maintainers",
    maintainer_email="maintainers@tracked-stack.invalid",
    description="Simulated tracked robot: physics with slipping belts, sensors, and the node that offers them.",
    license="Apache-2.0",
)
