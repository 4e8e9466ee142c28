from setuptools import find_packages, setup

NAME = "nmpc_layers"

setup(
    name=NAME,
    version="0.1.0",
    packages=find_packages(exclude=["test"]),
    package_data={NAME: ["py.typed", "data/*.yaml", "data/*.json"]},
    data_files=[
        ("share/ament_index/resource_index/packages", [f"resource/{NAME}"]),
        (f"share/{NAME}", ["package.xml"]),
        (f"share/{NAME}/config", [f"{NAME}/data/weights.yaml", f"{NAME}/data/upper_terminal.json"]),
    ],
    install_requires=["setuptools", "numpy", "casadi", "daqp", "pydantic>=2", "PyYAML"],
    zip_safe=False,
    maintainer="Tracked Stack maintainers",
    maintainer_email="maintainers@tracked-stack.invalid",
    description="Double-layer nonlinear model predictive control of a slipping tracked robot, and its solvers.",
    license="Apache-2.0",
    entry_points={
        "console_scripts": [
            "upper_nmpc = nmpc_layers.nodes.upper_nmpc:main",
            "lower_nmpc = nmpc_layers.nodes.lower_nmpc:main",
        ]
    },
)
