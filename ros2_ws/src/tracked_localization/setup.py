from setuptools import find_packages, setup

NAME = "tracked_localization"

setup(
    name=NAME,
    version="0.1.0",
    packages=find_packages(exclude=["test", "test.*"]),
    package_data={NAME: ["py.typed"]},
    data_files=[
        ("share/ament_index/resource_index/packages", [f"resource/{NAME}"]),
        (f"share/{NAME}", ["package.xml"]),
    ],
    install_requires=["setuptools", "numpy", "filterpy", "gtsam", "opencv-python-headless", "pydantic>=2", "scipy"],
    zip_safe=False,
    maintainer="Tracked Stack maintainers",
    maintainer_email="maintainers@tracked-stack.invalid",
    description="Where the tracked robot is and how its tracks slip: odometry filter, slip, maps, localisation.",
    license="Apache-2.0",
    entry_points={
        "console_scripts": [
            "ekf = tracked_localization.nodes.ekf:main",
            "slip_witness = tracked_localization.nodes.slip_witness:main",
            "localiser = tracked_localization.nodes.localiser:main",
            "map_server = tracked_localization.nodes.map_server:main",
            "mapper = tracked_localization.nodes.mapper:main",
        ]
    },
)
