"""Problems that one program would have with the text of a file."""

from collections.abc import Iterator

from tir.codegen.program import Switches, parameters_of
from tir.constants import LONGEST_READABLE_LINE
from tir.document import Document, FileLine, number_of, unquoted
from tir.equations.forces import Forces
from tir.errors import Problem, some
from tir.parameters import BY_NAME, REGULAR, TABLE
from tir.record import TyreRecord
from tir.targets import Target
from tir.units import KINDS, known_word

FIRST_OF_MODEL = 3
"""Keys of [MODEL] that matter to a program that reads by position: version, side, reference speed."""


def target_problems(tyre: TyreRecord, target: Target) -> Iterator[Problem]:
    """Problems of the tyre in one program, and of its file's text if it has one."""
    if target.refusal:
        yield Problem("error", f"{target.name} {target.refusal}")
    else:
        yield from (_named(problem, target) for problem in _content(tyre, target))
    yield from rule_problems(tyre, target)
    if tyre.document and not target.refusal:
        yield from (_named(problem, target) for problem in _text(tyre, tyre.document, target))


def rule_problems(tyre: TyreRecord, target: Target) -> Iterator[Problem]:
    """Problems of the tyre's values in a program, whatever the form of its file."""
    for rule in target.rules:
        said = rule.concerns(tyre)
        if said:
            value = tyre[rule.name] if rule.name else ""
            yield _named(Problem(rule.level, rule.sentence.format(value=value, said=said), rule.name), target)


def _named(problem: Problem, target: Target) -> Problem:
    return Problem(problem.level, f"for {target.name}: {problem.sentence}", problem.name, problem.line)


def _content(tyre: TyreRecord, target: Target) -> Iterator[Problem]:
    version = int(tyre["FITTYP"])
    if version not in target.fittyps:
        known = ", ".join(map(str, target.fittyps))
        said = f"FITTYP {version} is not supported, only {known}: {_remedy(target)}"
        yield Problem("error", said, "FITTYP")
    if target.complete and tyre.document is not None:
        missing = {r.name for r in TABLE if r.files in REGULAR} - {*tyre.present, *target.without}
        yield from _missing(missing, target.turn_slip and tyre.turn_slip)
    if not target.turn_slip and tyre.turn_slip:
        said = "it computes no turn slip, so camber and spin would be wrong: use the file for turn slip off"
        yield Problem("warning", said, "USE_MODE")
    if target.verified:
        yield Problem("note", f"how its demands are known: {target.known}; {target.verified}")


def _at(level: str, line: FileLine, sentence: str, name: str = "") -> Problem:
    """A problem at a line, about its key or another one."""
    return Problem(level, f"line {line.number}{sentence}", name or line.key, line.number)


def _remedy(target: Target) -> str:
    return f'write it for this program by tir.read(path).write(other, target="{target.name}")'


def _missing(names: set[str], turn_slip: bool) -> Iterator[Problem]:
    """Missing keys, for a program that needs complete files: an error for keys of the forces, else a warning."""
    forces = parameters_of(Forces._fields, Switches(turn_slip, limits=True))
    for level, those, why in (
        ("error", names & forces, "the forces need every key"),
        ("warning", names - forces, "the forces do not need them, but the program may require every key"),
    ):
        shown = [row.name for row in TABLE if row.name in those]
        if shown:
            yield Problem(level, f"the file lacks {some(shown)}; {why}: tyre.expand() adds the missing keys")


def _text(tyre: TyreRecord, document: Document, target: Target) -> Iterator[Problem]:
    keys = {line.key: line for line in reversed(document.entries)}
    if not document.text.isascii():
        line = next(line for line in document.lines if not line.text.isascii())
        yield _at("warning", line, " has characters outside ASCII")
    for line in document.lines:
        if len(line.text) >= LONGEST_READABLE_LINE:
            yield _at("warning", line, f" has {len(line.text)} characters")
        if target.dollar_only and line.key and "!" in line.text[line.start :].split("$")[0]:
            yield _at("error", line, f": only $ starts a comment here, so {line.key} would be read as text")
    if target.si:
        yield from _other_units(document)
    if target.positions:
        yield from _out_of_place(tyre, document, target)
    yield from _keys_of_its_own(keys, target)


def _other_units(document: Document) -> Iterator[Problem]:
    for line in document.entries:
        kind = KINDS.get(line.key, {}) if line.section == "UNITS" else {}
        if kind and kind.get(known_word(line.key, line.value), 1.0) != 1.0:
            said = f": {line.key} in {line.value} is ignored, and every number is taken as SI"
            yield _at("error", line, said)


def _out_of_place(tyre: TyreRecord, document: Document, target: Target) -> Iterator[Problem]:
    """For each section, the first key that a program which counts lines would read from a wrong line."""
    sections = dict.fromkeys(row.section for row in TABLE)
    regular = [row for row in TABLE if row.files in REGULAR and row.name not in target.without]
    for section in sections:
        rows = [row.name for row in regular if row.section == section]
        if section == "MODEL":
            rows = rows[:FIRST_OF_MODEL]
        body = [line for line in document.lines if line.section == section and not line.head]
        while body and not body[-1].key:
            body.pop()
        for line, name in zip(body, rows, strict=False):
            if line.key not in BY_NAME or tyre[line.key] != tyre[name]:
                found = line.key or "a line without a key"
                said = f": the program counts lines, and {found} is where it expects {name}"
                yield _at("error", line, said, name)
                break
        else:
            if len(body) < len(rows):
                said = f"[{section}] has too few lines for a program that counts lines"
                yield Problem("error", said, rows[len(body)])


def _keys_of_its_own(keys: dict[str, FileLine], target: Target) -> Iterator[Problem]:
    for name in target.more:
        if name not in keys:
            yield Problem("error", f"[MODEL] lacks {name}: {_remedy(target)}", name)
    for name, needed in target.values.items():
        if name in keys and needed not in (unquoted(keys[name].value), number_of(keys[name].value)):
            wanted = repr(needed) if isinstance(needed, str) else f"{needed:g}"
            sentence = f"{name} is {keys[name].value}, but has to be {wanted}: {_remedy(target)}"
            yield Problem("warning", sentence, name)
    if "FUNCTION_NAME" in keys and "USER_SUB_ID" in keys:
        said = ": USER_SUB_ID names the model in old files, FUNCTION_NAME in those of 6.2; keep one of them"
        yield _at("error", keys["USER_SUB_ID"], said)
    for line in keys.values():
        if not line.section and line.key in BY_NAME:
            yield _at("error", line, f": {line.key} comes before the first [SECTION]")
