"""Builds the conda package by its recipe, without a channel: a stand-in for cargo hands over the program that is built already.

    packaging/conda/try.py PROGRAM FOLDER

It shows that the recipe is valid, that its script and its tests run, and what the package holds; the compilers of conda-forge are not tried.
"""

import os
import pathlib
import sys

import rattler_build
import yaml

program, folder = pathlib.Path(sys.argv[1]).resolve(), pathlib.Path(sys.argv[2]).resolve()
here = pathlib.Path(__file__).resolve().parent

# As it stands, with the names of conda-forge's compilers.
compilers = "rust_compiler: [rust]\nc_compiler: [gcc]\nc_stdlib: [sysroot]\n"
rattler_build.Stage0Recipe.from_file(here / "recipe.yaml").render(rattler_build.VariantConfig.from_yaml(compilers))

tools = folder / "tools"
tools.mkdir(parents=True)
stand_ins = {
    # cargo install --locked --no-track --bins --root PREFIX --path .
    "cargo": f'mkdir -p "$6/bin" && cp "{program}" "$6/bin/"',
    # cargo-bundle-licenses --format yaml --output FILE
    "cargo-bundle-licenses": 'echo "not looked up" >"$4"',
}
for name, line in stand_ins.items():
    (tools / name).write_text(f"#!/bin/sh\nset -e\n{line}\n")
    (tools / name).chmod(0o755)
os.environ["PATH"] = f"{tools}:{os.environ['PATH']}"

recipe = yaml.safe_load((here / "recipe.yaml").read_text())
del recipe["requirements"]
# The program that is handed over is linked statically, which no path of libraries may be written into.
recipe["build"]["dynamic_linking"] = {"binary_relocation": False}
recipe["source"]["path"] = str(here.parent.parent)
recipe = rattler_build.Stage0Recipe.from_dict(recipe)
(built,) = recipe.run_build(
    tool_config=rattler_build.ToolConfiguration(test_strategy="native"),
    output_dir=folder / "output",
    channels=[],
    env_isolation=rattler_build.EnvironmentIsolation.NONE,
)
(package,) = built.packages
print(f"conda: {pathlib.Path(package).name}")
