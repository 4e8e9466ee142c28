from setuptools import find_packages, setup

NAME = "tracked_description"

setup(
    name=NAME,
    version="0.1.0",
    packages=find_packages(exclude=["test"]),
    package_data={NAME: ["py.typed", "data/*.yaml"]},
    data_files=[
        ("share/ament_index/resource_index/packages", [f"resource/{NAME}"]),
        (f"share/{NAME}", ["package.xml"]),
        (f"share/{NAME}/config", [f"{NAME}/data/robot.yaml"]),
    ],
    install_requires=["setuptools", "numpy", "pydantic>=2", "PyYAML"],
    zip_safe=False,
    entry_points={"console_scripts": ["description = tracked_description.nodes.description:main"]},
    maintainer="Tracked Stack maintainers",
    maintainer_email="maintainers@tracked-stack.invalid",
    description="Dimensions, limits, frames and sensor poses of the tracked robot, and the URDF made from them.",
    license="Apache-2.0",
)
