"""The packages of the distribution mffit; everything else about it is in ``pyproject.toml``.

The folder ``samples`` becomes the package data of ``mffit.samples`` in the wheel, where ``mffit init --sample`` finds it.
``pyproject.toml`` alone cannot both search for packages and take one from a folder of another name.
"""

from setuptools import find_packages, setup

setup(
    packages=[*find_packages(include=["tir", "tir.*", "mffit", "mffit.*"]), "mffit.samples"],
    include_package_data=False,  # MANIFEST.in is about the source distribution
    package_dir={"mffit.samples": "samples"},
    package_data={
        "tir": ["*.csv", "py.typed"],
        "mffit": ["**/*.csv", "**/*.j2", "**/*.css", "**/*.js", "**/*.toml", "py.typed"],
        "mffit.samples": ["README.md", "*/*.toml", "*/*.csv", "*/*.csv.gz", "*/*.tir", "*/*.json"],
    },
)
