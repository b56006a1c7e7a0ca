# SPDX-License-Identifier: Apache-2.0
"""The bad inputs that bad_input.py tries: files damaged, keys, cells and attributes replaced, places
that no file can be read from or written to, and options with values that they do not expect."""

import collections
import copy
import json
import os
import random
import re
import shutil
import subprocess

import inputs

QUICK = ["-o", "out", "--quiet"]

# A case. `words` is the command line. The message must contain one of `names`.
Case = collections.namedtuple("Case", "kind label words names")


class Tries:
    """Collects cases; each has a folder of its own."""

    def __init__(self, base, seed):
        self.base = base
        self.random = random.Random(seed)
        self.cases = []

    def folder(self):
        folder = self.base.root / "cases" / str(len(self.cases))
        folder.mkdir(parents=True, exist_ok=True)
        return folder

    def add(self, kind, label, words, *names):
        self.cases.append(Case(kind, label, [os.fsencode(w) if isinstance(w, (str, os.PathLike)) else w
                                             for w in words], names))

    def file(self, kind, label, name, contents, words, *names):
        """A case with one file; `words` is a function of its path."""
        path = self.folder() / name
        path.unlink(missing_ok=True)  # it may be a link to a good file
        path.write_bytes(contents if isinstance(contents, bytes) else contents.encode())
        self.add(kind, label, words(path), name, *names)


# Values, as texts of YAML, that no key expects in this form.
VALUES = {
    "text": "abc", "list": "[1, 2]", "mapping": "{a: 1}", "0": "0", "-1": "-1", "tiny": "1e-300",
    "huge": "1e300", "too huge": "1e999", "nan": ".nan", "infinity": ".inf", "nothing": "",
    "true": "true", "empty text": '""', "long list": "[" + "1, " * 20000 + "1]",
    "long text": "x" * 5000, "escape": '"\\e[2J"', "deep": "[" * 60 + "]" * 60,
}


def paths_of(value, path=()):
    """Every key and every first entry of a list in nested dictionaries and lists."""
    if path:
        yield path
    if isinstance(value, dict):
        for key, inner in value.items():
            yield from paths_of(inner, path + (key,))
    elif isinstance(value, list) and value:
        yield from paths_of(value[0], path + (0,))


def with_value(document, path, text):
    """The document as YAML with the value at the path replaced by a text."""
    changed = copy.deepcopy(document)
    inner = changed
    for step in path[:-1]:
        inner = inner[step]
    inner[path[-1]] = "@VALUE@"
    return json.dumps(changed).replace('"@VALUE@"', text)


def yaml_keys(tries, kind, name, document, words, share=1.0):
    """Every key with every value, or a share of these, drawn by the seed."""
    for path in paths_of(document):
        key = next((str(step) for step in reversed(path) if isinstance(step, str)), name)
        for label, text in VALUES.items():
            if tries.random.random() > share:
                continue
            tries.file(kind, f"{'.'.join(map(str, path))} = {label}", name,
                       with_value(document, path, text), words, key)
        if tries.random.random() <= share:
            tries.file(kind, f"{'.'.join(map(str, path))} unknown", name,
                       json.dumps(document).replace(f'"{key}": ', f'"{key}x": ', 1), words, key)


def damaged(data, rng):
    """Kinds of damage that any file can have."""
    lines = data.split(b"\n")
    middle = len(lines) // 2
    yield "empty", b""
    yield "cut in a line", data[: len(data) // 2 - 3]
    yield "NUL byte", data[:100] + b"\0" + data[100:]
    yield "not UTF-8", data[:20] + b"\xff\xfe\xe9" + data[20:]
    yield "random bytes", rng.randbytes(3000)
    yield "UTF-16", data.decode(errors="replace").encode("utf-16")
    yield "a line twice", b"\n".join(lines[:middle] + [lines[middle]] * 2 + lines[middle:])
    yield "one long line", b"x" * (3 << 20)
    yield "escape characters", data.replace(lines[0], b"\x1b[2J\x1b]0;owned\x07" + lines[0], 1)
    yield "other file", b"%PDF-1.4\n1 0 obj\n"
    yield "nested 100 000 deep", b"[" * 100000
    yield "nested mappings", b'{"a":' * 100000


def any_files(tries, kind, name, data, words):
    for label, contents in damaged(data, tries.random):
        tries.file(kind, label, name, contents, words)


def table_cells(tries, kind, name, data, separator, words, count=2):
    """Replaced cells of the header and of rows; missing rows and columns."""
    lines = data.decode().rstrip("\n").split("\n")
    values = ["", "abc", "nan", "inf", "1e300", "1e999", "-1e300", "1,5", "caf\u00e9", "9" * 400,
              "1e-320", "0x10", '"', "\x1b[2J"]
    for row in [0] + [tries.random.randrange(len(lines) // 2, len(lines)) for _ in range(count)]:
        for value in values:
            cells = lines[row].split(separator)
            cells[tries.random.randrange(len(cells))] = value
            tries.file(kind, f"row {row}: a cell {value[:8]!r}", name,
                       "\n".join(lines[:row] + [separator.join(cells)] + lines[row + 1:]) + "\n",
                       words)
    header = lines[0].split(separator)
    tries.file(kind, "header only", name, lines[0] + "\n", words)
    tries.file(kind, "no header", name, "\n".join(lines[1:]), words)
    tries.file(kind, "a column twice", name,
               "\n".join(line + separator + line.split(separator)[-1] for line in lines), words)
    tries.file(kind, "a column less", name,
               "\n".join(line.rsplit(separator, 1)[0] for line in lines), words, header[-1])
    tries.file(kind, "100 000 columns", name,
               "\n".join(line + (separator + "1") * 100000 for line in lines[:4]), words)


def strange_places(tries, base):
    """Places that cannot be an input or an output, for each option that names a file."""
    root = base.root / "places"
    (root / "folder").mkdir(parents=True)
    os.mkfifo(root / "pipe")
    os.symlink("loop", root / "loop")
    os.symlink("nowhere", root / "dangling")
    bad = root / os.fsdecode(b"caf\xe9\x1b[2J")
    bad.mkdir()
    sparse = root / "sparse"
    with open(sparse, "wb") as stream:
        stream.truncate(40 << 30)
    places = {"pipe": root / "pipe", "loop": root / "loop", "dangling": root / "dangling",
              "folder": root / "folder", "device": "/dev/zero", "terminal": "/dev/tty",
              "no name": "", "none": root / "none", "below a file": sparse / "x",
              "long name": root / ("x" * 300), "long path": root / ("x/" * 3000),
              "40 GB": sparse, "not UTF-8": bad / "none", "memory": "/proc/self/mem"}
    calibrate = lambda project, recording, *out: ["calibrate", project, "--recording", recording,
                                                 *(out or QUICK)]
    reads = {
        "project": lambda p: ["inspect", p],
        "recording": lambda p: calibrate(base.project, p),
        "calibration": lambda p: ["validate", base.project, "--recording", base.recording,
                                  "--calibration", p],
        "compare": lambda p: ["compare", base.out, p],
        "check": lambda p: ["check", base.project, "--recording", base.table, "--calibration", p],
        "prior": lambda p: calibrate(base.project, base.table, "--prior", p, *QUICK),
        "marker places": lambda p: calibrate(base.project, base.table, "--marker-places", p, *QUICK),
        "after": lambda p: ["design", base.design, "--after", p, "-o", base.root / "after.yaml"],
        "report": lambda p: ["report", p],
        "earlier": lambda p: ["report", base.out, "-o", base.root / "page.html", "--earlier", p],
        "postures": lambda p: ["assess", base.design, "--postures", p],
        "motion": lambda p: ["simulate", base.project, "-o", base.root / "motion", "--motion", p],
        "settings": lambda p: ["simulate", base.project, "-o", base.root / "set", "--settings", p],
    }
    for what, words in reads.items():
        for label, place in places.items():
            named = [os.path.basename(str(place))] if str(place) else ["is empty", "is required"]
            tries.add("places of inputs", f"{what}: {label}", words(place), *named)
    outputs = dict(places, full="/dev/full", processes="/proc/x/y", kernel="/sys")
    outputs.pop("device")
    for label in ("pipe", "terminal", "none", "not UTF-8"):
        outputs.pop(label)
    writes = {
        "--json": lambda p: ["inspect", base.project, "--json", p],
        "report": lambda p: ["report", base.out, "-o", p],
        "calibrate": lambda p: calibrate(base.project, base.recording, "-o", p),
        "simulate": lambda p: ["simulate", base.project, "-o", p] + inputs.SHORT,
    }
    for what, words in writes.items():
        for label, place in outputs.items():
            tries.add("places of outputs", f"{what}: {label}", words(place),
                      os.path.basename(str(place)) or "name")
    for file in [base.recording / "arm.tsv", base.recording / "arm.csv", base.table, base.project,
                 base.urdf, base.out / "calibration.yaml", base.out / "covariance.csv"]:
        copied = tries.folder() / file.name
        shutil.copy(file, copied)
        tries.add("places of outputs", f"--json over {file.name}",
                  ["inspect", base.project, "--json", copied], file.name)
    tries.add("places of outputs", "standard output is full", ["inspect", base.project], "output")


def plan_of_an_arm(command):
    """Good values still do not plan a motion of a robot without legs."""
    return ["expected a leg", "does not lie flat"] if command == "plan" else []


def options(tries, base):
    """Every option of every command with values that it does not expect."""
    calls = {
        "inspect": [base.project], "compare": [base.out, base.out], "report": [base.out],
        "calibrate": [base.project, "--recording", base.table, *QUICK],
        "validate": [base.project, "--recording", base.table, "--calibration", base.out],
        "check": [base.project, "--recording", base.table, "--calibration", base.out],
        "assess": [base.design, "--postures", base.postures],
        "design": [base.design, "--count", "2", "-o", base.root / "p.yaml"],
        "plan": [base.design, "--postures", base.postures, "-o", base.root / "m.csv"],
        "simulate": [base.project, "-o", base.root / "s"] + inputs.SHORT,
        "demo": [],
    }
    values = ["nan", "-1", "1e300", "1e-300", "abc", "", "inf", "99999999999999999999", "0x10",
              b"\xff\xe9", "\x1b[2J", "1,5"]
    for command, words in calls.items():
        text = subprocess.run([base.program, command, "--help"], capture_output=True, text=True,
                              check=True).stdout
        for option in sorted(set(re.findall(r"(--[a-z0-9-]+) [A-Z]+", text))):
            if option in ("--json", "--output"):
                continue
            # The demonstration runs for minutes with any value that it accepts.
            for value in values if command != "demo" else ["nan", "-1", "abc"]:
                # The simulation has many options of one kind.
                if command == "simulate" and tries.random.random() > 0.4:
                    continue
                shown = {b"\xff\xe9": "\ufffd\ufffd", "\x1b[2J": "?[2J"}.get(value, value)
                tries.add(f"options of {command}", f"{option} {value!r}",
                          [command, *words, option, value], option, shown or "''", "is empty",
                          "is required", "cross-validation",
                          option[2:].replace("-", "_"), "experiment.yaml", *plan_of_an_arm(command))
        tries.add(f"options of {command}", "unknown", [command, *words, "--no-such-option"],
                  "--no-such-option")


def urdfs(tries, base):
    """Every numeric attribute of every element, and links that form no tree."""
    text = base.urdf.read_text()
    words = lambda path: ["calibrate", base.project_for(path), "--recording", base.recording,
                          *QUICK]
    values = ["nan", "inf", "1e300", "-1e300", "1e9", "-1", "0", "abc", "", "1e-300", "1 2", "1,5"]
    seen = set()
    for match in re.finditer(r"<(\w+)([^>]*)>", text):
        for attribute in re.finditer(r'(\w+)="([^"]*)"', match.group(2)):
            key = (match.group(1), attribute.group(1))
            if key in seen:
                continue
            seen.add(key)
            begin = match.start(2) + attribute.start(2)
            for value in values:
                whole = value if len(attribute.group(2).split()) < 3 else f"{value} 0 0"
                tries.file("URDF", f"{'.'.join(key)} = {value}", "robot.urdf",
                           text[:begin] + whole + text[begin + len(attribute.group(2)):], words)
    for label, contents in inputs.bad_urdfs(text).items():
        tries.file("URDF", label, "robot.urdf", contents, words)
        tries.file("URDF", f"simulated: {label}", "robot.urdf", contents,
                   lambda path: ["simulate", base.project_for(path), "-o", path.parent / "s"] +
                   inputs.SHORT)
    any_files(tries, "URDF", "robot.urdf", text.encode(), words)


def results(tries, base):
    """Damaged results for all of their readers, without SHA256SUMS."""
    readers = {
        "calibration.yaml": [
            lambda p: ["validate", base.project, "--recording", base.table, "--calibration", p],
            lambda p: ["compare", p, base.out], lambda p: ["report", p.parent]],
        "covariance.csv": [
            lambda p: ["compare", p.parent, base.out], lambda p: ["report", p.parent],
            lambda p: ["check", base.project, "--recording", base.table, "--calibration", p.parent]],
    }
    for name in ["summary.json", "report_data.json", "validation.json", "runs.json",
                 "robot_data.json", "comparison.json", "x_summary.json", "m_margins.json"]:
        readers[name] = [lambda p: ["report", p.parent]]
    for name, all_words in readers.items():
        source = base.out / name
        data = source.read_bytes() if source.exists() else b'{"status": "moved", "joints": []}'
        damages = dict(damaged(data, tries.random))
        if name.endswith(".json"):
            damages.update({"a list": b"[]", "null": b"null", "1e999": b'{"a": 1e999}',
                            "nested objects": b'{"a":' * 100000 + b"1" + b"}" * 100000})
        else:
            lines = data.split(b"\n")
            for at in range(1, len(lines) - 1, max(1, len(lines) // 12)):
                damages[f"cut after line {at}"] = b"\n".join(lines[:at]) + b"\n"
        if name == "calibration.yaml":
            line = next(l for l in lines if b"elbow_joint.theta" in l)
            for label, other in {"line missing": b"", "unknown joint": line.replace(b"elbow", b"elbov"),
                                 "metres": line.replace(b"unit: rad", b"unit: m"),
                                 "nan": re.sub(rb"value: [^,]*", b"value: nan", line),
                                 "1e300": re.sub(rb"value: [^,]*", b"value: 1e300", line),
                                 "twice": line + b"\n" + line}.items():
                damages[label] = data.replace(line + b"\n", other + b"\n" if other else b"")
        for label, contents in damages.items():
            for number, words in enumerate(all_words):
                folder = tries.folder()
                # If report_data.json is there, the page takes the robot from it.
                left_out = ["SHA256SUMS", "report.html"] + ["report_data.json"] * (name == "robot_data.json")
                shutil.copytree(base.out, folder, dirs_exist_ok=True, copy_function=os.link,
                                ignore=shutil.ignore_patterns(*left_out))
                if name == "m_margins.json":
                    (folder / "m.csv").write_text("time,a\n0,1\n")
                tries.file(f"results: {name}", f"{label}, reader {number + 1}", name, contents, words)
    folder = tries.folder()
    shutil.copytree(base.out, folder, dirs_exist_ok=True)
    (folder / "summary.json").write_text("{}")
    for words in [["report", folder], ["compare", folder, base.out]]:
        tries.add("results: two runs", words[0], words, "two runs")


def all_tries(base, seed):
    tries = Tries(base, seed)
    calibrate = lambda path: ["calibrate", path, "--recording", base.recording, *QUICK]
    yaml_keys(tries, "project file", "project.yaml", base.full_project, calibrate, 0.5)
    any_files(tries, "project file", "project.yaml", base.project.read_bytes(), calibrate)
    experiment = lambda path: ["calibrate", base.project, "--recording", path.parent, *QUICK]
    any_files(tries, "experiment.yaml", "experiment.yaml",
              (base.recording / "experiment.yaml").read_bytes(), experiment)
    yaml_keys(tries, "experiment.yaml", "experiment.yaml", base.experiment, experiment)
    table = lambda path: ["calibrate", base.project, "--recording", path, *QUICK]
    any_files(tries, "posture table", "table.csv", base.table.read_bytes(), table)
    table_cells(tries, "posture table", "table.csv", base.table.read_bytes(), ",", table)
    for name, separator in [("arm.csv", ","), ("arm.tsv", "\t")]:
        kind = "joint log" if separator == "," else "Qualisys TSV"
        words = lambda path: ["calibrate", base.project, "--recording",
                              base.recording_with(path), *QUICK]
        any_files(tries, kind, name, (base.recording / name).read_bytes(), words)
        table_cells(tries, kind, name, (base.recording / name).read_bytes(), separator, words)
    assess = lambda path: ["assess", base.design, "--postures", path]
    any_files(tries, "posture file", "postures.yaml", base.postures.read_bytes(), assess)
    yaml_keys(tries, "posture file", "postures.yaml", json.loads(base.postures.read_text()), assess)
    play = lambda path: ["simulate", base.project, "-o", path.parent / "s", "--motion", path]
    any_files(tries, "motion", "motion.csv", base.motion.encode(), play)
    table_cells(tries, "motion", "motion.csv", base.motion.encode(), ",", play)
    tries.file("motion", "rows 1e6 s apart", "motion.csv",
               "time,elbow_joint\n0,0.1\n1000000,0.2\n", play)
    settings = lambda path: ["simulate", base.project, "-o", path.parent / "s", "--settings", path,
                             *inputs.SHORT]
    for text in ["upper_stiffness_least: 1000000\n", "least_lag_s: 100\n"]:
        tries.file("simulation settings", "least above largest", "settings.yaml", text, settings,
                   text.split(":")[0])
    any_files(tries, "simulation settings", "settings.yaml", b"marker_noise_mm: 0.1\n", settings)
    yaml_keys(tries, "simulation settings", "settings.yaml", base.settings, settings, 0.3)
    places = lambda path: ["calibrate", base.project, "--recording", base.table, "--marker-places", path, *QUICK]
    measured = (b"marker,x_mm,y_mm,z_mm,sd_mm,link\nTOOL_1,25.2,44.9,20.1,0.5,\nTOOL_2,-25,-50.3,35.2,0.5,tool\n"
                b"TOOL_3,12.1,60.2,39.8,0.5,\nWRIST,35.1,40,45.2,0.5,\n")
    any_files(tries, "marker places", "places.csv", measured, places)
    table_cells(tries, "marker places", "places.csv", measured, ",", places)
    urdfs(tries, base)
    results(tries, base)
    strange_places(tries, base)
    options(tries, base)
    return tries.cases
