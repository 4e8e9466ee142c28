from setuptools import find_packages, setup

NAME = "casadi_code"

setup(
    name=NAME,
    version="0.1.0",
    packages=find_packages(exclude=["test"]),
    package_data={NAME: ["py.typed"]},
    data_files=[
        ("share/ament_index/resource_index/packages", [f"resource/{NAME}"]),
        (f"share/{NAME}", ["package.xml"]),
    ],
    install_requires=["setuptools", "numpy", "casadi"],
    zip_safe=False,
    maintainer="Tracked Stack maintainers",
    maintainer_email="maintainers@tracked-stack.invalid",
    description="CasADi functions as machine code, called without copies; knows no ROS and no robot.",
    license="Apache-2.0",
)
