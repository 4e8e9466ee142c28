from glob import glob

from setuptools import find_packages, setup

NAME = "robust_core"
EXTRAS = {
    "solve": ["clarabel", "scipy"],
    "formulas": ["casadi"],
    "exact": ["python-flint"],
    "cli": ["PyYAML", "matplotlib"],
}

setup(
    name=NAME,
    version="0.1.0",
    packages=find_packages(exclude=["test"]),
    package_data={NAME: ["py.typed", "specs/*.yaml"]},
    data_files=[
        ("share/ament_index/resource_index/packages", [f"resource/{NAME}"]),
        (f"share/{NAME}", ["package.xml"]),
        # What `ros2 run` finds. As console scripts pip would put such general names on everybody's path.
        (f"lib/{NAME}", sorted(glob("scripts/*"))),
    ],
    python_requires=">=3.11",
    install_requires=["setuptools", "numpy>=1.26"],
    extras_require={**EXTRAS, "all": sorted({name for names in EXTRAS.values() for name in names})},
    entry_points={"console_scripts": [f"{NAME} = robust_core.command_line.main:main"]},
    zip_safe=False,
    maintainer="Tracked Stack maintainers",
    maintainer_email="maintainers@tracked-stack.invalid",
    description="Robust control and estimation of nonlinear plants; knows no ROS and no robot.",
    license="Apache-2.0",
)
