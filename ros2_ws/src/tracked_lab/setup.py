from setuptools import find_packages, setup

NAME = "tracked_lab"

setup(
    name=NAME,
    version="0.1.0",
    packages=find_packages(exclude=["test"]),
    package_data={NAME: ["py.typed", "data/recordings/*", "data/weights/*", "data/campaigns/*", "data/*.yaml"]},
    data_files=[
        ("share/ament_index/resource_index/packages", [f"resource/{NAME}"]),
        (f"share/{NAME}", ["package.xml"]),
    ],
    install_requires=["setuptools", "numpy", "pydantic>=2"],
    entry_points={"console_scripts": ["campaign = tracked_lab.campaign.command_line:main"]},
    zip_safe=False,
    maintainer="Tracked Stack maintainers",
    maintainer_email="maintainers@tracked-stack.invalid",
    description="The stack in one process and in lock-step, without ROS: where evidence is made.",
    license="Apache-2.0",
)
