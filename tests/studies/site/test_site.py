"""The documentation: it builds with all links whole, its numbers are rows, its references to code exist."""

from __future__ import annotations

import ast
import re
import subprocess
import sys
from pathlib import Path

import pytest

from solvers.errors import Cause
from studies.scene.bellows import BellowsScene
from studies.scene.sections import Section
from studies.site.columns import columns_page
from studies.site.formulas import hidden, shown
from studies.site.messages import CAUSES, all_messages, messages_of, messages_page
from studies.site.problems import sheets
from studies.site.scene_keys import scene_page
from studies.site.values import ValueMissing, banded, filled, value

ROOT = Path(__file__).resolve().parents[3]
DOCS = ROOT / "docs"
PAGES = sorted(path for path in DOCS.rglob("*.md") if path.name != "report.md")
REFERENCE = re.compile(r"`((?:analytical|bellowsx|meshes|solvers|studies|tests)/[\w/.]+\.py): ([\w.]+)`")


def label(path: Path) -> str:
    return path.relative_to(DOCS).as_posix()


def names_in(path: Path) -> set[str]:
    """Functions, classes, methods and constants that a file defines."""
    found = set()
    for node in ast.parse(path.read_text(encoding="utf-8")).body:
        if isinstance(node, ast.FunctionDef | ast.ClassDef):
            found.add(node.name)
        if isinstance(node, ast.ClassDef):
            for part in node.body:
                if isinstance(part, ast.FunctionDef):
                    found.add(f"{node.name}.{part.name}")
        targets = node.targets if isinstance(node, ast.Assign) else [getattr(node, "target", None)]
        found |= {target.id for target in targets if isinstance(target, ast.Name)}
    return found


@pytest.mark.parametrize("page", PAGES, ids=label)
def test_references_to_code_exist(page: Path) -> None:
    for file, name in REFERENCE.findall(page.read_text(encoding="utf-8")):
        assert (ROOT / file).exists(), (file, name)
        assert name in names_in(ROOT / file), (file, name)


def test_site_builds_with_all_links_whole(tmp_path: Path) -> None:
    command = [sys.executable, "-m", "mkdocs", "build", "--quiet", "--strict", "--site-dir", str(tmp_path / "site")]
    done = subprocess.run(command, cwd=ROOT, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stdout + done.stderr
    front = (tmp_path / "site" / "index.html").read_text(encoding="utf-8")
    assert "{{" not in front
    outside = re.findall(r'<(?:script|link|img)[^>]+(?:src|href)="(https?://[^"]+)"', front)
    assert outside == []
    theory = (tmp_path / "site" / "theory" / "mixed-form.html").read_text(encoding="utf-8")
    assert "<math" in theory and "⟦" not in theory


def test_numbers_are_those_of_rows() -> None:
    assert filled('{{ value("paper", "heung-t1-ri5", "tip_mm", "paper_experiment", 20, digits=0) }}') == "141"
    # as the README has it: not of the meshes that are for the audit of uncertainties
    assert banded("paper", "heung-t1-ri5", "tip_mm", "full3d", 20) in (ROOT / "README.md").read_text(encoding="utf-8")
    with pytest.raises(ValueMissing, match="no tip_mm of nobody"):
        value("paper", "nobody", "tip_mm", "full3d", 20)


def test_formulas_in_code_and_prices_stay() -> None:
    assert hidden("`$a$` costs 5$ or 6$") == "`$a$` costs 5$ or 6$"
    assert "<math" not in hidden("$a_1$ is") and "<math" in shown(hidden("$a_1$ is"))
    assert 'display="block"' in shown(hidden("$$\na = b\n$$"))


def test_every_key_of_a_bellows_has_a_meaning() -> None:
    page = scene_page()
    for name, field in BellowsScene.model_fields.items():
        section = field.annotation
        if isinstance(section, type) and issubclass(section, Section):
            for key, inner in section.model_fields.items():
                assert f"| `{key}` |" in page
                assert inner.description, f"{name}.{key}"


def test_columns_of_files_are_listed() -> None:
    page = columns_page()
    assert "| `error_percent` |" in page and "| `tip_force_n` | N |" in page and "`peak_mb`" in page


def test_every_cause_has_a_meaning_and_a_remedy() -> None:
    assert set(CAUSES) == set(Cause)
    assert "unknown key" in messages_page()
    assert len(list(all_messages())) > 200


def test_messages_are_read_from_source() -> None:
    source = 'def f(a):\n    """Say."""\n    raise MeshError(f"{a}: a mesh of two pieces: join them")\n'
    (message,) = messages_of(source, "x.py")
    assert (message.text, message.error) == ("…: a mesh of two pieces: join them", "MeshError")
    lines = 'def f(a):\n    return ["key = 3: must be less than four"]\n'
    assert [m.text for m in messages_of(lines, "x.py", lines=True)] == ["key = 3: must be less than four"]


def test_a_sheet_per_exact_problem() -> None:
    found = dict(sheets())
    assert {"tube", "sphere", "ring-2", "cook", "cube"} <= set(found)
    assert "exact: tube in plane strain" in found["tube"] and "```toml" in found["tube"]
    assert "Observed orders" in found["tube"]
