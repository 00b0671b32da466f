"""The scripts of the pages: ES modules in the folder ``scripts``, joined to one text when a page is written."""

import re
from importlib.resources import files

IMPORT = re.compile(r'^import \{[^}]*\} from "\./(\w+)\.js";\n', re.MULTILINE)
EXPORT = re.compile(r"^export (?=(?:async function|function|const|let)\b)", re.MULTILINE)


def module(name: str) -> str:
    """The text of a module."""
    return files("mffit.viewer").joinpath("scripts", f"{name}.js").read_text(encoding="utf-8")


def script(name: str) -> str:
    """A module with all that it imports, each behind those that it imports, in one scope.

    A page is one file without a server, where a browser loads no module from another file. A name at the top of a module stands
    for one thing in all modules, so that nothing has to be renamed; two of one name are an error in every engine.
    """
    parts: dict[str, str] = {}

    def add(one: str) -> None:
        text = module(one)
        for needed in IMPORT.findall(text):
            if needed not in parts:
                add(needed)
        parts[one] = EXPORT.sub("", IMPORT.sub("", text))

    add(name)
    return "\n".join(parts.values())
