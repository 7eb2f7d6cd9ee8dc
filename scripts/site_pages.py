"""Pages of the site that are not in docs/, and links that lead there. MkDocs calls these functions; see mkdocs.yml."""

import posixpath
import re
import shutil
import tomllib
from pathlib import Path

from mkdocs.exceptions import PluginError
from mkdocs.structure.files import File, InclusionLevel

ROOT = Path(__file__).parents[1]
LINK = re.compile(r"(\[(?:[^\[\]]|!?\[[^\]]*\]\([^)]*\))*\])\(([^)\s]+)\)")
LANGUAGES = {".rs": "rust", ".py": "python", ".toml": "toml", ".sh": "sh", "": "text", ".txt": "text"}

PYTHON = """# Reference of the Python package

::: freeform_motion
"""


def crates():
    """Folder and name of every crate with an interface in Rust."""
    folders = [folder for folder in sorted((ROOT / "crates").iterdir()) if folder.name not in ("cli", "python")]
    manifests = {folder: tomllib.loads((folder / "Cargo.toml").read_text())["package"] for folder in [ROOT, *folders]}
    return {folder: (package["name"], package["description"]) for folder, package in manifests.items()}


def rust_page():
    """A page that leads to the pages of rustdoc, which lie beside those of MkDocs."""
    rows = [
        f'| <a href="rust/{name.replace("-", "_")}/index.html"><code>{name}</code></a> | {description} |'
        for name, description in crates().values()
    ]
    return "\n".join(["# Reference of the crates", "", "| crate | what it is |", "|---|---|", *rows, ""])


def page_of(path):
    """Where a file or folder of the checkout is in the site, or None: a path as in `page_sources`."""
    if path == "src":
        return "rust-reference.md"
    if path.startswith("docs/"):
        return path.removeprefix("docs/")
    return next((page for page, source in page_sources().items() if path in (source, posixpath.dirname(source) or ".")), None)


def page_sources():
    """Pages that are made of files outside docs/."""
    pages = {"index.md": "README.md", "changelog.md": "CHANGELOG.md"}
    folders = [*sorted((ROOT / "crates").iterdir()), ROOT / "examples/distributed", ROOT / "examples/recipes"]
    for folder in folders:
        name = folder.relative_to(ROOT).as_posix()
        pages[f"{name}.md"] = f"{name}/README.md"
    return pages


def on_files(files, config):
    """Adds the pages, and every file of the checkout that one of them links to."""
    # Pages of sources and of most crates are reached by links alone.
    aside = InclusionLevel.NOT_IN_NAV
    for page, source in page_sources().items():
        files.append(File.generated(config, page, content=(ROOT / source).read_text(), inclusion=aside))
    files.append(File.generated(config, "python-reference.md", content=PYTHON))
    files.append(File.generated(config, "rust-reference.md", content=rust_page()))
    linked = set()
    for file in files.documentation_pages():
        for _, target in LINK.findall(file.content_string):
            path = resolved(target, source_of(file.src_uri))
            if path and page_of(path) is None and (ROOT / path).is_file():
                linked.add(path)
    for path in sorted(linked):
        language = LANGUAGES.get(Path(path).suffix, "text")
        text = f"# {Path(path).name}\n\n````{language}\n{(ROOT / path).read_text()}\n````\n"
        files.append(File.generated(config, f"sources/{path}.md", content=text, inclusion=aside))
    return files


def source_of(page):
    """The file of the checkout that a page is made of."""
    return page_sources().get(page, f"docs/{page}")


def resolved(target, source):
    """The path in the checkout that a link leads to, or None for links that lead elsewhere."""
    path = target.partition("#")[0]
    if not path or "://" in target or target.startswith("mailto:"):
        return None
    return posixpath.normpath(posixpath.join(posixpath.dirname(source), path))


def on_page_markdown(markdown, page, config, files):
    """Links between files become links between pages; hidden lines of Rust examples go."""
    source = source_of(page.file.src_uri)
    if page.file.src_uri.startswith("sources/") or page.file.src_uri.endswith("-reference.md"):
        return markdown

    def moved(match):
        text, target = match.groups()
        # A picture that is itself a link.
        text = LINK.sub(moved, text) if "](" in text else text
        path = resolved(target, source)
        if path is None:
            return f"{text}({target})"
        anchor = target.partition("#")[1] + target.partition("#")[2]
        there = page_of(path) or (f"sources/{path}.md" if (ROOT / path).is_file() else None)
        if there is None or (ROOT / path).is_dir() and path.startswith("docs/"):
            if not (ROOT / path).is_dir():
                raise PluginError(f"{source}: {target} leads nowhere")
            # A folder without a page of its own.
            return text[1:-1]
        return f"{text}({posixpath.relpath(there, posixpath.dirname(page.file.src_uri) or '.')}{anchor})"

    pieces = re.split(r"(^```.*?^```$)", markdown, flags=re.DOTALL | re.MULTILINE)
    return "".join(shown(piece) if piece.startswith("```") else LINK.sub(moved, piece) for piece in pieces)


def shown(block):
    """A block of code as rustdoc would show it."""
    return re.sub(r"^# .*\n|^#\n", "", block, flags=re.MULTILINE) if block.startswith("```rust") else block


def on_post_build(config):
    """Puts the pages of rustdoc beside, where they were made."""
    made = ROOT / "target" / "doc"
    if made.is_dir():
        shutil.copytree(made, Path(config["site_dir"]) / "rust", dirs_exist_ok=True)
