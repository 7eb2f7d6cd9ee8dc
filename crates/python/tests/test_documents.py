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
