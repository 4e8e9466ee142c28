from setuptools import find_packages, setup

NAME = "tracked_safety"

setup(
    name=NAME,
    version="0.1.0",
    packages=find_packages(exclude=["test"]),
    package_data={NAME: ["py.typed"]},
    data_files=[
        ("share/ament_index/resource_index/packages", [f"resource/{NAME}"]),
        (f"share/{NAME}", ["package.xml"]),
    ],
    install_requires=["setuptools", "numpy"],
    zip_safe=False,
    maintainer="Tracked Stack maintainers",
    maintainer_email="maintainers@tracked-stack.invalid",
    description="The last node before the base: one command source at a time, limits, watchdog, e-stop.",
    license="Apache-2.0",
    entry_points={
        "console_scripts": [
            "command_arbiter = tracked_safety.nodes.command_arbiter:main",
            "teleop_joy = tracked_safety.nodes.teleop_joy:main",
            "teleop_keyboard = tracked_safety.nodes.teleop_keyboard:main",
        ]
    },
)
