from setuptools import find_packages, setup

NAME = "tracked_types"

setup(
    name=NAME,
    version="0.1.0",
    packages=find_packages(exclude=["test"]),
    package_data={NAME: ["py.typed"]},
    data_files=[
        ("share/ament_index/resource_index/packages", [f"resource/{NAME}"]),
        (f"share/{NAME}", ["package.xml"]),
    ],
    install_requires=["setuptools", "numpy", "pydantic>=2", "PyYAML"],
    zip_safe=False,
    maintainer="Tracked Stack maintainers",
    maintainer_email="maintainers@tracked-stack.invalid",
    description="ROS-free data types that every package of the tracked-robot stack shares.",
    license="Apache-2.0",
)
