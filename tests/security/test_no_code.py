"""No module of the product can unpickle, evaluate or import what data name, but the few that are listed here."""

import ast
from collections.abc import Iterator
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
MODULES = sorted(
    path
    for package in ("agent_proc", "planner_proc", "sim_proc", "shared/legpush")
    for path in (ROOT / package).rglob("*.py")
)
ALLOWED = {
    ("agent_proc/policies/sb3/model_file.py", "pickle"): "a normalizer that the command line names and trusts",
    ("agent_proc/policies/sb3/old_folder.py", "pickle"): "the error of PyTorch's loader, which loads weights alone",
    ("agent_proc/policies/registry.py", "load_address"): "a policy that the command line names",
    ("shared/legpush/study/cells.py", "load_address"): "a kind of cell that the command line names",
    ("shared/legpush/plugins.py", "import_module"): "`load_address`, whose callers are listed here",
    ("shared/legpush/entry/program.py", "import_module"): "the program that the command line of this process names",
    ("shared/legpush/__init__.py", "import_module"): "names of the package itself",
}
CODE_MODULES = {"pickle", "cloudpickle", "dill", "joblib", "shelve", "marshal", "code", "codeop", "runpy"}
CODE_CALLS = {
    *("eval", "exec", "compile", "__import__", "import_module", "spec_from_file_location", "run_path", "run_module"),
    *("load_address", "system", "popen", "unsafe_load", "full_load", "load_all", "from_xml_path"),
}
METHODS_ALLOWED = {"compile"}
"""Methods with the name of a dangerous function, such as `re.compile`."""


def dangers(path: Path) -> Iterator[str]:
    """What a module uses that could run code of its data."""
    for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
        if isinstance(node, ast.Import | ast.ImportFrom):
            names = [alias.name for alias in node.names]
            modules = names if isinstance(node, ast.Import) else [node.module or ""]
            yield from (module for module in modules if module.partition(".")[0] in CODE_MODULES)
        if isinstance(node, ast.Call):
            of_module = isinstance(node.func, ast.Attribute)
            name = node.func.attr if isinstance(node.func, ast.Attribute) else getattr(node.func, "id", "")
            if name in CODE_CALLS and not (of_module and name in METHODS_ALLOWED):
                yield name
            flags = {keyword.arg: ast.unparse(keyword.value) for keyword in node.keywords}
            if flags.get("shell") == "True":
                yield "shell=True"
            where = ast.unparse(node.func)
            if where in ("np.load", "numpy.load") and flags.get("allow_pickle") != "False":
                yield where
            if where == "torch.load" and flags.get("weights_only") != "True":
                yield where
            if where == "yaml.load":
                yield where


def test_there_are_modules() -> None:
    assert len(MODULES) > 200


@pytest.mark.parametrize("path", MODULES, ids=lambda path: str(path.relative_to(ROOT)))
def test_no_module_runs_code_of_its_data(path: Path) -> None:
    name = str(path.relative_to(ROOT))

    assert {danger for danger in dangers(path) if (name, danger) not in ALLOWED} == set()


def test_every_exception_is_used() -> None:
    assert {(name, danger) for name, _ in ALLOWED for danger in dangers(ROOT / name)} == set(ALLOWED)


@pytest.mark.parametrize(
    "line",
    [
        "import pickle",
        "from pickle import loads",
        "eval(x)",
        "importlib.import_module(x)",
        "os.system(x)",
        "subprocess.run(x, shell=True)",
        "np.load(x)",
        "np.load(x, allow_pickle=True)",
        "torch.load(x)",
        "torch.load(x, weights_only=False)",
        "yaml.load(x, Loader)",
        "mujoco.MjModel.from_xml_path(x)",
    ],
)
def test_each_danger_is_seen(tmp_path: Path, line: str) -> None:
    (tmp_path / "x.py").write_text(line)
    assert list(dangers(tmp_path / "x.py"))


@pytest.mark.parametrize(
    "line", ["re.compile(x)", "np.load(x, allow_pickle=False)", "torch.load(x, weights_only=True)", "yaml.safe_load(x)"]
)
def test_what_is_harmless_is_let_alone(tmp_path: Path, line: str) -> None:
    (tmp_path / "x.py").write_text(line)
    assert not list(dangers(tmp_path / "x.py"))
