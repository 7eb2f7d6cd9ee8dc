"""The Python code of the documents runs."""

import re
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[3]


@pytest.mark.parametrize("document", ["README.md", "docs/python.md", "crates/python/README.md"])
def test_code_in_the_documents_runs(document, capsys):
    blocks = re.findall(r"^```python\n(.*?)^```", (ROOT / document).read_text(), re.DOTALL | re.MULTILINE)
    assert blocks, document
    for block in blocks:
        exec(compile(block, document, "exec"), {})
    assert "omega" in capsys.readouterr().out


@pytest.mark.parametrize("source", sorted((ROOT / "docs/notebooks").glob("*.py")), ids=lambda source: source.stem)
def test_pages_of_notebooks_have_the_text_and_code_of_their_sources(source):
    page = source.with_suffix(".md").read_text()
    cells = re.split(r"^# %%", source.read_text(), flags=re.MULTILINE)[1:]
    assert len(cells) > 5
    for cell in cells:
        kind, _, body = cell.partition("\n")
        text = re.sub(r"^# ?", "", body, flags=re.MULTILINE) if "markdown" in kind else body
        text = re.sub(r"\n{3,}", "\n\n", text.strip())
        assert text in page, f"run scripts/render-notebooks docs/notebooks: {text[:200]}"
    for picture in re.findall(r"!\[Figure\]\((.*?)\)", page):
        assert (source.parent / picture).stat().st_size > 1000, picture
