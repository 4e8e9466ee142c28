from setuptools import find_packages, setup

NAME = "tracked_navigation"

setup(
    name=NAME,
    version="0.1.0",
    packages=find_packages(exclude=["test"]),
    package_data={NAME: ["py.typed"]},
    data_files=[
        ("share/ament_index/resource_index/packages", [f"resource/{NAME}"]),
        (f"share/{NAME}", ["package.xml"]),
    ],
    install_requires=["setuptools", "casadi", "numpy", "opencv-python-headless", "pydantic>=2", "PyYAML", "scipy"],
    zip_safe=False,
    maintainer="Tracked Stack maintainers",
    maintainer_email="maintainers@tracked-stack.invalid",
    description="Reference trajectories from shapes and files, and driving to goals on a map.",
    license="Apache-2.0",
    entry_points={
        "console_scripts": [
            "navigator = tracked_navigation.nodes.navigator:main",
            "trajectory_player = tracked_navigation.nodes.trajectory_player:main",
        ]
    },
)
