"""Judges the JSON Schemas with the Python package jsonschema (https://python-jsonschema.readthedocs.io).

Run from the project's root: python3 tests/study/references/judge_schemas.py
Needs Python 3.11 (tomllib) and jsonschema 4; reads *.schema.json beside it, writes judgements.json.
Exits with 1 if the judgements differ from the recorded ones and --check is given.
"""

import json
import pathlib
import sys
import tomllib
from importlib.metadata import version

import jsonschema

HERE = pathlib.Path("tests/study/references")
GOOD = [
    "reports/habe/study.toml",
    "distributions/habe.toml",
    *sorted(str(path) for path in pathlib.Path("tests/study/accepted").glob("*.toml")),
]
BAD = sorted(str(path) for path in pathlib.Path("tests/study/corpus").glob("*.toml"))


def validator(name):
    schema = json.loads((HERE / name).read_text(encoding="utf-8"))
    jsonschema.Draft202012Validator.check_schema(schema)
    return jsonschema.Draft202012Validator(schema)


def main():
    study, card = validator("study.schema.json"), validator("card.schema.json")
    accepted, refused, malformed = [], [], []
    for path in GOOD + BAD:
        name = pathlib.Path(path).name
        judge = card if name.startswith("card_") or path.startswith("distributions/") else study
        try:
            document = tomllib.loads(pathlib.Path(path).read_text(encoding="utf-8"))
        except tomllib.TOMLDecodeError:
            malformed.append(path)
            continue
        errors = sorted(judge.iter_errors(document), key=str)
        if errors and path in GOOD:
            sys.exit(f"{path}: {errors[0]}")
        (refused if errors else accepted).append(path)
    result = {
        "judge": f"jsonschema {version('jsonschema')}",
        "accepted": accepted,
        "refused": refused,
        "malformed": malformed,
    }
    text = json.dumps(result, indent=1, ensure_ascii=False) + "\n"
    file = HERE / "judgements.json"
    if "--check" in sys.argv:
        old = json.loads(file.read_text(encoding="utf-8"))
        if any(old[key] != result[key] for key in ("accepted", "refused", "malformed")):
            sys.exit("the judgements differ from the recorded ones")
        return
    file.write_text(text, encoding="utf-8")


main()
