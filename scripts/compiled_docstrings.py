"""Docstrings of the compiled part of the Python package, for its reference.

griffe, which reads the package, takes signatures and types from the stubs, which have no docstrings. What is compiled has its docstrings
in itself. See mkdocs.yml.
"""

import inspect

import griffe

import freeform_motion


class CompiledDocstrings(griffe.Extension):
    """Gives every class, method and property of the stubs the docstring of what it stands for."""

    def on_package(self, *, pkg, **_):
        if pkg.name != "freeform_motion":
            return
        for name, described in pkg["_native"].members.items():
            compiled = getattr(freeform_motion, name, None)
            if not described.is_alias and described.is_class and compiled is not None:
                document(described, compiled)
                show_how_it_is_made(described)
                for member, inner in described.members.items():
                    if not member.startswith("_"):
                        document(inner, getattr(compiled, member))


def document(described, compiled):
    """Sets a docstring; that of a public name must not be missing."""
    text = inspect.getdoc(compiled)
    if not text:
        raise ValueError(f"{described.path} has no docstring")
    described.docstring = griffe.Docstring(text, parent=described, parser=griffe.Parser.numpy)


def show_how_it_is_made(described):
    """Lets the signature of a class be that of `__new__`, which is what compiled classes have."""
    made_by = described.members.get("__new__")
    if made_by is not None:
        parameters = griffe.Parameters(*made_by.parameters)
        described.set_member("__init__", griffe.Function("__init__", parameters=parameters, parent=described))
