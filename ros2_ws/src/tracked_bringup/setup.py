from glob import glob

from setuptools import find_packages, setup

NAME = "tracked_bringup"

setup(
    name=NAME,
    version="0.1.0",
    packages=find_packages(exclude=["test"]),
    package_data={NAME: ["py.typed", "data/*.yaml", "data/maps/*", "data/routes/*", "data/scenarios/*.yaml"]},
    data_files=[
        ("share/ament_index/resource_index/packages", [f"resource/{NAME}"]),
        (f"share/{NAME}", ["package.xml"]),
        (f"share/{NAME}/launch", glob("launch/*.launch.py")),
    ],
    install_requires=["setuptools", "numpy", "pydantic>=2", "PyYAML", "rosbags"],
    zip_safe=False,
    maintainer="Tracked Stack maintainers",
    maintainer_email="maintainers@tracked-stack.invalid",
    description="Starts, watches, records and ends the graph of nodes that a scenario needs.",
    license="Apache-2.0",
    entry_points={
        "console_scripts": [
            "bringup = tracked_bringup.bringup:main",
            "mcap_recorder = tracked_bringup.nodes.mcap_recorder:main",
            "node_group = tracked_bringup.node_group:main",
            "recorder = tracked_bringup.nodes.recorder:main",
            "replay = tracked_bringup.nodes.replay:main",
        ]
    },
)
