"""Installed domains and solvers, options of a domain, and plugins that do not load."""

from __future__ import annotations

import subprocess
import sys
from importlib.metadata import EntryPoint
from pathlib import Path

import pytest

import factored_pomdp as fp
from factored_pomdp import registry


def entry_points_are(monkeypatch: pytest.MonkeyPatch, *points: EntryPoint) -> None:
    monkeypatch.setattr("importlib.metadata.entry_points", lambda group: [p for p in points if p.group == group])


@pytest.mark.example
def test_built_in_domains_and_solvers_are_listed_with_their_summaries() -> None:
    found = {entry.name: entry for entry in registry.domains()}
    assert {"tiger", "machine-repair", "surveillance"} <= set(found)
    assert found["tiger"].summary == "The tiger problem."
    assert found["tiger"].distribution.startswith("factored-pomdp ")
    assert found["tiger"].error is None
    assert {"myopic", "myopic-joint"} <= {entry.name for entry in registry.solvers()}
    assert all(entry.error is None and entry.summary for entry in registry.solvers())


@pytest.mark.example
def test_a_broken_plugin_is_named_and_the_rest_works(monkeypatch: pytest.MonkeyPatch) -> None:
    good = EntryPoint("tiger", "factored_pomdp.domains.tiger:tiger", registry.DOMAINS)
    broken = EntryPoint("lion", "no_such_module_anywhere:lion", registry.DOMAINS)
    entry_points_are(monkeypatch, good, broken)
    found = {entry.name: entry for entry in registry.domains()}
    assert found["lion"].error == "ModuleNotFoundError: No module named 'no_such_module_anywhere'"
    assert found["tiger"].error is None
    assert fp.domain("tiger").joint_states == 2
    with pytest.raises(ValueError, match=r"'lion' .* cannot be loaded: ModuleNotFoundError"):
        fp.domain("lion")


@pytest.mark.example
def test_a_plugin_that_exits_ends_nothing(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    (tmp_path / "plugin_that_exits.py").write_text("import sys\nsys.exit(3)\n", encoding="utf-8")
    monkeypatch.syspath_prepend(str(tmp_path))
    entry_points_are(monkeypatch, EntryPoint("lion", "plugin_that_exits:lion", registry.DOMAINS))
    assert [entry.error for entry in registry.domains()] == ["SystemExit: 3"]
    with pytest.raises(ValueError, match=r"'lion' .* cannot be loaded: SystemExit: 3"):
        fp.domain("lion")


@pytest.mark.example
def test_a_name_offered_twice_is_said(monkeypatch: pytest.MonkeyPatch) -> None:
    one = EntryPoint("tiger", "factored_pomdp.domains.tiger:tiger", registry.DOMAINS)
    two = EntryPoint("tiger", "factored_pomdp.domains.machine_repair:machine_repair", registry.DOMAINS)
    entry_points_are(monkeypatch, one, two)
    errors = [entry.error for entry in registry.domains()]
    assert errors.count(None) == 1
    assert any(error and "taken" in error for error in errors)
    assert fp.domain("tiger").name == next(e for e in registry.domains() if e.error is None).load()().name


@pytest.mark.example
def test_an_entry_point_found_twice_is_one_domain(monkeypatch: pytest.MonkeyPatch) -> None:
    one = EntryPoint("tiger", "factored_pomdp.domains.tiger:tiger", registry.DOMAINS)
    entry_points_are(monkeypatch, one, one)
    assert [(entry.name, entry.error) for entry in registry.domains()] == [("tiger", None)]


@pytest.mark.example
@pytest.mark.parametrize(
    ("name", "options", "said"),
    [
        ("tigr", {}, r"no domain 'tigr' is installed \(did you mean 'tiger'\?\)"),
        ("tiger", {"acuracy": "1"}, r"no option 'acuracy' \(did you mean 'accuracy'\?\).*Its options: accuracy.*0\.85"),
        ("tiger", {"accuracy": "loud"}, "option accuracy=loud: input should be a valid number"),
        ("machine-repair", {"machines": 2.5}, "option machines=2.5: input should be a valid integer"),
        ("machine-repair", {"machines": "x", "coupled": "x"}, "machines=x: .*; option coupled=x: "),
        ("machine-repair", {"machines": "0"}, "machines=0: expected 1 to 10,000"),
    ],
)
def test_wrong_options_are_one_message(name: str, options: dict, said: str) -> None:
    with pytest.raises(ValueError, match=said):
        fp.domain(name, **options)


@pytest.mark.example
def test_strings_are_read_as_the_annotations_ask() -> None:
    model = fp.domain("machine-repair", machines="2", coupled="true", discount="0.5")
    assert (len(model.states), model.discount) == (2, 0.5)
    assert "machine1" in model.transition["machine2"].names
    assert fp.domain("surveillance", site="micro", targets="1", detection_probability="none").joint_states > 1


@pytest.mark.end_to_end
def test_listing_loads_no_solver_of_plans_and_no_picture() -> None:
    program = (
        "import sys\nfrom factored_pomdp import registry\nregistry.domains(); registry.solvers()\n"
        "print([n for n in ('matplotlib', 'pgmpy', 'cvxpy', 'PIL', 'scipy.optimize') if n in sys.modules])"
    )
    answer = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, check=True)
    assert answer.stdout.strip() == "[]"
