#!/usr/bin/env python3
"""Checks the rules of the house that no compiler checks: check_house.py [--root DIR] [CHECK ...]

includes  a file includes from its own floor or below; the library takes nothing from apps/; rooms of apps/cli do not include each other
          in circles
rooms     nothing lies loose in src/; no folder holds more than 16 sources
names     one name, one meaning: no name is defined in two files of one namespace
prose     files open with their name and purpose; comments are whole and start with their subject

Without a CHECK all of them. Each problem is a line `file:line: got, expected`. Exits with 1 where there is one,
with 77, which ctest takes as skipped, where names are to be checked and there is no ctags.
"""
import argparse
import collections
import pathlib
import re
import shutil
import subprocess
import sys

# From the ground up. Commands, window and bindings share the roof: nothing of the library is above them.
FLOORS = ["core", "data", "io", "shade", "render", "compare", "convert", "voxelize", "evaluate", "web", "sample", "apps"]

# A public header stands where the lowest source that defines something of it stands, so that this source may
# include it. lod.h and distributed.h declare the calls of higher floors too: their structs are data.
PUBLIC_HEADERS = {
    "core": "error linear memory progress temporary_file text",
    "data": "camera cells dense distributed fields gaussians image levels lod points subject units value_counts volume voxel_values",
    "io": "exchange model_io openvdb ply scan_io site surface vogz volume_io voxel_field",
    "shade": "exposure quantity shade value_transfer",
    "render": "clip field_maps periodic picture picture_record renderer request_schema scene volume_picture",
    "compare": "compare compare_maps vogz_fit",
    "convert": "budget_search conversion_schema convert convert_cells convert_fields convert_labels convert_moments convert_paper convert_points",
    "voxelize": "voxelize",
    "evaluate": "evaluate",
    "web": "export_html",
    "sample": "sample",
    "apps": "vog",  # everything: for users, never for the library itself
}
FLOOR_OF_HEADER = {f"vog/{name}.h": floor for floor, names in PUBLIC_HEADERS.items() for name in names.split()}

CPP = {".h", ".cpp", ".cu"}
SOURCES = CPP | {".js", ".vert", ".frag", ".css", ".html"}
MOST_SOURCES = 16


def files(root, folders, suffixes):
    """Paths relative to root, sorted: the same report on every machine."""
    found = (path for folder in folders for path in (root / folder).rglob("*"))
    return sorted(path.relative_to(root) for path in found if path.suffix in suffixes and path.is_file())


def lines(root, path):
    return enumerate((root / path).read_text(encoding="utf-8").splitlines(), start=1)


def floor_of(included_or_path):
    """Of "vog/image.h", "io/byte_source.h" and their paths below include/ and src/; None if it has none."""
    floor = FLOOR_OF_HEADER.get(included_or_path, included_or_path.split("/")[0])
    return floor if floor in FLOORS else None


def check_includes(root):
    problems, count = [], 0
    for path in files(root, ["include/vog", "src"], CPP):
        own_name = path.relative_to(path.parts[0]).as_posix()
        own_floor = floor_of(own_name)
        if not own_floor:
            expected = ("an entry in PUBLIC_HEADERS of scripts/check_house.py" if path.parts[0] == "include"
                        else f"a folder of {', '.join(FLOORS[:-1])}")
            problems.append(f"{path}:1: on no floor, expected {expected}")
            continue
        for number, line in lines(root, path):
            included = re.match(r'\s*#\s*include\s*(?:"([^"]+)"|<(vog/[^>]+)>)', line)
            if not included:
                continue
            count += 1
            name = included[1] or included[2]
            where = f'{path}:{number}: includes "{name}"'
            floor = floor_of(name)
            if not any((root / base / name).is_file() for base in ("include", "src")):
                problems.append(f"{where}, expected a path below include/ or src/")
            elif path.parts[0] == "include" and not name.startswith("vog/"):
                problems.append(f"{where}, expected public headers alone: no other is installed")
            elif floor and FLOORS.index(floor) > FLOORS.index(own_floor):
                problems.append(f"{where} of floor {floor}, expected {own_floor} or below")
    for path in files(root, ["src"], {".txt"}):
        problems += [f"{path}:{number}: takes {line.strip()!r}, expected no source from apps/"
                     for number, line in lines(root, path) if re.search(r"\bapps/", line.split("#")[0])]
    problems += circles(root)
    return problems, f"{count} includes"


def circles(root):
    """Rooms of the command that include each other in circles, by the includes that close one."""
    base = pathlib.Path("apps/cli")
    into = collections.defaultdict(dict)  # room -> room: an include
    for path in files(root, [str(base)], CPP):
        for number, line in lines(root, path):
            included = re.match(r'#include "([^"]+)"', line)
            if included and (root / base / included[1]).is_file():
                room = (base / included[1]).parent
                if room != path.parent:
                    into[path.parent].setdefault(room, f'{path}:{number}: includes "{included[1]}"')

    def reaches(start, end, seen):
        return start == end or any(reaches(n, end, seen | {start}) for n in into[start] if n not in seen)
    return [f"{text}, expected no circle of rooms" for room in sorted(into) for other, text in sorted(into[room].items())
            if reaches(other, room, set())]


def check_rooms(root):
    problems = [f"{path.relative_to(root)}:1: loose in src/, expected in the room of its stage"
                for path in sorted((root / "src").iterdir()) if path.is_file() and path.name != "CMakeLists.txt"]
    rooms = collections.Counter(path.parent for path in files(root, ["src", "apps"], SOURCES))
    problems += [f"{room}:1: {size} sources, expected at most {MOST_SOURCES}: give it rooms"
                 for room, size in sorted(rooms.items()) if size > MOST_SOURCES]
    return problems, f"{len(rooms)} rooms"


Definition = collections.namedtuple("Definition", "name file line kind namespace parameters")


def parameter_types(signature):
    """'(const Volume& volume, int n = 4)' -> ('const Volume&', 'int'): two overloads differ in these."""
    types, depth, start = [], 0, 1
    for i, letter in enumerate(signature):
        depth += (letter in "(<[{") - (letter in ")>]}")
        if (letter == "," and depth == 1) or (letter == ")" and depth == 0):
            parameter = signature[start:i].split("=")[0].strip()
            # A name follows a type: `std::size_t count`, but not the second word of `unsigned int`.
            named = re.fullmatch(r"(.*[\s&*>])(?!(?:int|long|char|double|short)$)[A-Za-z_]\w*", parameter)
            types.append((named[1] if named and named[1].strip() != "const" else parameter).replace(" ", ""))
            start = i + 1
    return tuple(types)


def definitions(root):
    """All types, functions and variables at namespace scope, read by Universal Ctags. Left out: main (one a
    program), names of anonymous namespaces (one a file), specialisations (one meaning by design) and explicit
    instantiations, which look like variables."""
    command = ["ctags", "--language-force=C++", "--kinds-C++=cfgstuv", "--fields=+nKsSZ",
               "--fields-C++=+{template}{specialization}", "--sort=no", "-f", "-", "-L", "-"]
    paths = "\n".join(map(str, files(root, ["include", "src", "apps", "python"], CPP)))
    try:
        tags = subprocess.run(command, input=paths, cwd=root, capture_output=True, text=True, check=True).stdout
    except subprocess.CalledProcessError as error:
        sys.exit(f"check_house: ctags says {error.stderr.strip()}, expected Universal Ctags (scripts/install-deps.sh)")
    for tag in filter(lambda tag: not tag.startswith("!"), tags.splitlines()):
        # The pattern between file and kind may hold tabs of its own; it ends in ;"
        name, file, rest = tag.split("\t", 2)
        kind, *pairs = rest.rsplit(';"\t', 1)[1].split("\t")
        fields = dict(pair.split(":", 1) for pair in pairs)
        scope_kind, _, scope = fields.get("scope", "namespace:").partition(":")
        if (scope_kind != "namespace" or "__anon" in scope + name or "specialization" in fields
                or fields.get("template") == "<>" or (name == "main" and not scope)
                or (kind == "variable" and rest.startswith("/^template class "))):
            continue
        parameters = parameter_types(fields.get("signature", "()")) if kind == "function" else None
        yield Definition(name, file, int(fields["line"]), kind, scope, parameters)


def check_names(root):
    """A function may have the name of another with other parameters, of nothing else."""
    problems, by_name, count = [], collections.defaultdict(list), 0
    for new in definitions(root):
        count += 1
        for old in by_name[new.namespace, new.name]:
            if old.file != new.file and (old.parameters is None or new.parameters is None
                                         or old.parameters == new.parameters):
                problems.append(f"{new.file}:{new.line}: {new.kind} {new.namespace}::{new.name}, expected another "
                                f"name than that of the {old.kind} at {old.file}:{old.line}")
                break
        by_name[new.namespace, new.name].append(new)
    return problems, f"{count} definitions"


# A sentence that opens with one of these names its subject too late.
LATE = "what|of|that|those|it|who"
# Not what(), nor a parameter called `of`, which two spaces part from its meaning.
STARTS_LATE = re.compile(rf"(?:{LATE})\b(?!\(|  )", re.IGNORECASE)
CAPITAL_LATE = re.compile(rf"(?:^|[.!?]\s+)(?:{'|'.join(word.title() for word in LATE.split('|'))})\b")
# A formatter that joins the lines of a table leaves its labels, and the two spaces behind them, inside.
JOINED = re.compile(r"\S\s+(returns|throws|cost|memory)  ")


def comments(root, path):
    """(line number, whether code stands before it, text) of every line with a comment."""
    sign = r"#+" if path.suffix == ".py" else r"//+[!<]*"
    for number, line in lines(root, path):
        # No slash of https://
        found = re.match(rf"(.*?)(?<!:){sign}\s*(.*)$", line)
        if found:
            yield number, bool(found[1].strip()), found[2]


def check_joined(root):
    for path in files(root, ["include", "src", "apps", "python"], SOURCES | {".py"}):
        for number, _, text in comments(root, path):
            joined = JOINED.search(text)
            if joined:
                yield f"{path}:{number}: '{joined[1]}  ' inside a comment line, expected at its start"


def check_sentences(root):
    for path in files(root, ["include/vog"], {".h"}):
        last_number, last_text = 0, ""
        for number, behind_code, text in comments(root, path):
            new_sentence = behind_code or number != last_number + 1 or re.search(r"(^|[.!?])$", last_text)
            if CAPITAL_LATE.search(text) or (new_sentence and STARTS_LATE.match(text)):
                yield f"{path}:{number}: '{text}', expected no sentence that starts with {LATE.replace('|', ', ')}"
            last_number, last_text = number, text


def check_openings(root):
    for path in files(root, ["include", "src", "apps"], CPP):
        names = [f"vog/{path.name}"] if path.parts[0] == "include" else [path.name]
        if path.parent.name == "device":
            names.append(f"device/{path.name}")
        first = next(lines(root, path), (1, ""))[1]
        sentence = next((first.removeprefix(f"// {name}: ") for name in names if first.startswith(f"// {name}: ")), "")
        if not sentence.strip() or STARTS_LATE.match(sentence):
            yield (f"{path}:1: '{first}', expected '// {names[0]}: ' and a sentence that does not start with "
                   f"{LATE.replace('|', ', ')}")


def check_prose(root):
    found = {"joined lines": list(check_joined(root)), "late subjects": list(check_sentences(root)),
             "openings": list(check_openings(root))}
    return sum(found.values(), []), ", ".join(f"{len(problems)} {kind}" for kind, problems in found.items())


CHECKS = {"includes": check_includes, "rooms": check_rooms, "names": check_names, "prose": check_prose}


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--root", type=pathlib.Path, default=pathlib.Path(__file__).resolve().parents[1])
    parser.add_argument("checks", nargs="*", metavar="CHECK", help=f"of {', '.join(CHECKS)}")
    arguments = parser.parse_args()
    if unknown := set(arguments.checks) - set(CHECKS):
        parser.error(f"no check {', '.join(sorted(unknown))}, expected {', '.join(CHECKS)}")
    checks = arguments.checks or CHECKS
    if "names" in checks and not shutil.which("ctags"):
        print("check_house: no ctags here, expected universal-ctags (scripts/install-deps.sh)", file=sys.stderr)
        sys.exit(77)
    failed = False
    for name in checks:
        problems, extent = CHECKS[name](arguments.root)
        print(*problems, f"{name}: {extent}, {len(problems)} problems", sep="\n")
        failed |= bool(problems)
    sys.exit(failed)


if __name__ == "__main__":
    main()
