"""The package as a whole."""

from __future__ import annotations

import ast
import inspect
import os
import pathlib
import re
import subprocess
import sys

import pytest

import rockfall as rf
from rockfall import _rockfall

TESTS = pathlib.Path(__file__).parent


def public() -> list[str]:
    """All public functions, methods and properties, as Class.name."""
    found = []
    for name in rf.__all__:
        cls = getattr(rf, name)
        if inspect.isfunction(cls):
            found.append(name)
        elif name == "Settings":
            # The constants have tests of their own.
            found += [f"Settings.{member}" for member in ("items", "keys", "update")]
        elif inspect.isclass(cls) and not issubclass(cls, (tuple, Exception)):
            own = [base for base in cls.__mro__ if base.__module__.startswith("rockfall")]
            found += sorted({f"{name}.{member}" for base in own for member in vars(base) if not member.startswith("_")})
    return found


def test_info_names_the_versions_and_devices() -> None:
    info = rf.info()
    assert info.version == rf.__version__ == _rockfall.__version__
    assert info.devices == rf.devices()
    assert info.backend in ("cpu", "gpu") and "arrays" in str(info)


def test_dir_shows_what_is_public() -> None:
    assert [name for name in dir(rf) if not name.startswith("__")] == sorted([*rf.__all__, "gym", "typing"])
    assert all(hasattr(rf, name) for name in dir(rf))


def test_gym_is_there_after_the_import_and_names_what_is_missing() -> None:
    script = "import sys; sys.modules['gymnasium'] = None; import rockfall as rf; assert 'gym' not in dir(rf); rf.gym"
    found = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True, check=False)
    assert found.stderr.endswith("ImportError: rockfall.gym needs Gymnasium: pip install 'rockfall[gym]'\n")
    script = "import rockfall as rf, sys; assert 'gymnasium' not in sys.modules; print(rf.gym.make_vec.__name__)"
    found = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True, check=False)
    assert (found.stdout, found.stderr) == ("make_vec\n", "")


def test_everything_public_is_documented() -> None:
    missing = []
    for name in public():
        owner = rf
        for part in name.split("."):
            owner = inspect.getattr_static(owner, part)
        is_field = isinstance(owner, (int, str, float)) or type(owner).__name__ == "member_descriptor"
        if not is_field and not inspect.getdoc(owner):
            missing.append(name)
    assert missing == []


def test_everything_public_is_used_in_a_test() -> None:
    trees = [ast.parse(path.read_text()) for path in TESTS.glob("test_*.py")]
    attributes = [node for tree in trees for node in ast.walk(tree) if isinstance(node, ast.Attribute)]
    of_package = {node.attr for node in attributes if isinstance(node.value, ast.Name) and node.value.id == "rf"}
    of_objects = {node.attr for node in attributes}
    unused = [name for name in public() if name.split(".")[-1] not in (of_objects if "." in name else of_package)]
    assert unused == []
    assert {"film", "sweep", "view", "Simulation.run"} <= set(public())


def test_the_stubs_declare_what_the_native_module_has() -> None:
    stub = pathlib.Path(rf.__file__).with_name("_rockfall.pyi").read_text()
    classes: dict[str, set[str]] = {}
    current = ""
    functions = set()
    for line in stub.splitlines():
        if found := re.match(r"class (\w+)", line):
            current = found[1]
            classes[current] = set()
        elif found := re.match(r"    def (\w+)", line):
            classes[current].add(found[1])
        elif found := re.match(r"def (\w+)", line):
            functions.add(found[1])
    native = {name: getattr(_rockfall, name) for name in dir(_rockfall) if not name.startswith("__")}
    assert {name for name, value in native.items() if inspect.isclass(value)} == set(classes)
    assert {name for name, value in native.items() if not inspect.isclass(value)} == functions
    for name, members in classes.items():
        if name != "SimulationError":
            own = {member for member in vars(native[name]) if not member.startswith("_")}
            assert own == {member for member in members if not member.startswith("__")}, name


def test_the_example_of_the_package_runs() -> None:
    code = [line[4:] for line in (rf.__doc__ or "").splitlines() if line.startswith(">>> ")]
    assert len(code) >= 7
    names: dict[str, object] = {}
    for line in code:
        if line != "sim.positions.shape":
            exec(line, names)  # noqa: S102
    sim = names["sim"]
    assert isinstance(sim, rf.Simulation) and sim.positions.shape == (1000, 3)


@pytest.mark.parametrize("page", ["README.md", "docs/python.md"])
def test_the_examples_of_the_documentation_run_as_a_file(page: str, tmp_path: pathlib.Path) -> None:
    text = (TESTS.parents[2] / page).read_text()
    marked = re.findall(r"(<!-- not run: [^>]*-->\n)?```python\n(.*?)```", text, re.DOTALL)
    # check_device.py runs what needs an NVIDIA card.
    blocks = [block for mark, block in marked if not mark]
    assert len(blocks) > len(marked) / 2
    script = tmp_path / "page.py"
    script.write_text("\n".join(blocks))
    environment = {**os.environ, "MPLBACKEND": "agg"}
    command = [sys.executable, "-W", "ignore", script]
    found = subprocess.run(command, cwd=tmp_path, env=environment, capture_output=True, text=True, check=False)
    assert (found.returncode, found.stderr) == (0, "")
