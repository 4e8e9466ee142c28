from setuptools import find_packages, setup

NAME = "tracked_report"

setup(
    name=NAME,
    version="0.1.0",
    packages=find_packages(exclude=["test", "test.*"]),
    package_data={NAME: ["py.typed", "data/*.yaml", "templates/*"]},
    data_files=[
        ("share/ament_index/resource_index/packages", [f"resource/{NAME}"]),
        (f"share/{NAME}", ["package.xml"]),
    ],
    install_requires=["setuptools", "numpy", "pydantic>=2", "PyYAML", "matplotlib", "Jinja2"],
    entry_points={
        "console_scripts": [
            "claims = tracked_report.claims:main",
            "render = tracked_report.render:main",
        ]
    },
    zip_safe=False,
    maintainer="Tracked Stack maintainers",
    maintainer_email="maintainers@tracked-stack.invalid",
    description="Scenario schema, run records, metrics, plots, HTML reports and the claims ledger; no ROS.",
    license="Apache-2.0",
)
