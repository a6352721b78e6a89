# SPDX-License-Identifier: MIT
"""Run verification cases, judge them by the table of gates, and write the report; or list them, or
draw the figures of a report as PDF.

The folder holds the pages (index.html and one for each group of cases), results.json, gates.csv,
junit.xml, figures/ and runs/ (every solve). results.json says "complete": false while the cases
run, so that a broken run is never read as a result.
"""

from __future__ import annotations

import json
import shutil
import sys
import time
from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass
from pathlib import Path
from tempfile import TemporaryDirectory
from textwrap import fill

from sam.scene import Progress
from verification.cases import Case, all_cases, case_of
from verification.cases.case import Context, NotDrawnError, Outcome
from verification.judging import Row, RowStatus, Verdict, evaluate
from verification.rows import load_rows, read_cases
from verification.runs import provenance
from verification.runs.code_version import version_of_cases
from verification.runs.files import FolderError, plain, write_atomically
from verification.runs.lock import locked
from verification.runs.store import Lookup, Reuse, Store
from verification.suite import outcomes
from verification.suite.freshness import Earlier, older
from verification.suite.pages import INDEX, remove_pages, write_report
from verification.suite.pages.stored import ASKED, ELSEWHERE, NAMED
from verification.suite.records import gates_csv, junit_xml, origin, results_json, text_rows, unreadable
from verification.text.console import print_table, table_lines, unknown

FORMAT = "samfem-verification"
RESULTS = "results.json"
NOTHING = Earlier()
WIDTH = 100
"""Characters of a line of a reason."""
BEFORE = "before"
"""Key of results.json while a report is in the making: that of the report whose cases stay."""


@dataclass(frozen=True)
class RanCase:
    """A case that was run or reused. failure: why it broke off, or empty; seconds: of its own run;
    source: where it is from, or why it was not taken from the store.
    """

    context: Context
    outcome: Outcome
    failure: str
    seconds: float
    source: Reuse


def main(
    cases: list[str],
    level: str,
    out: Path,
    progress: Progress | None = None,
    *,
    store: Store | None = None,
) -> int:
    """Run the named cases (none: all of the level), or take them from the store, and write the report into
    `out`. A name that ends with .toml is a file of own cases, which then are all that there are.

    Returns 0 when every gate of every case that ran held and its figures can be read, 1 when not, 2 for an
    unknown case or a folder that holds something else (nothing is written then). An earlier report
    in `out` is replaced. A case that needs what is not there is not run, with the reason; if that is so for
    all, nothing is written.
    """
    files = [each for name in cases if name.endswith(".toml") for each in read_cases(Path(name))]
    known = {file.name: case_of(file) for file in files} or all_cases()
    cases = [name for name in cases if not name.endswith(".toml")] or list(known if files else ())
    problem = problem_of(cases, known, out)
    if problem:
        print(f"samfem: error: {problem}", file=sys.stderr)
        return 2
    chosen, unmet = runnable(
        [case for case in known.values() if (case.name in cases if cases else level in case.levels)]
    )
    if not chosen:
        return 0
    with locked(out):
        start(out)
        told = progress or (lambda stage, done, total: None)
        ran = _run(chosen, level=level, out=out, progress=told, store=store)
        words = " ".join(["samfem verify", *cases, "--level", level])  # where to is the reader's
        return finish(ran, known, level=level, out=out, command=words, unmet=unmet)


def finish(
    ran: Mapping[str, RanCase],
    known: Mapping[str, Case],
    *,
    level: str,
    out: Path,
    command: str,
    unmet: Mapping[str, str],
    stays: Earlier = NOTHING,
) -> int:
    """Judge the cases that ran, write the report into `out` and say what is red.

    known: all cases by name; unmet: name -> why a case could not run here; stays: of an earlier
    report. Of the other cases that did not run results.json says under `unmet` where they belong.
    Returns 0 when every gate of every case that ran held, else 1.
    """
    results = _judged(ran, known, level=level, stays=stays) | {"command": command}
    for record in results["cases"]:
        record["unmet"] = unmet.get(record["name"], "")
        if record["status"] == RowStatus.NOT_RUN and not record["unmet"]:
            levels = known[record["name"]].levels
            record["unmet"] = ELSEWHERE[ASKED if level in levels else next(iter(levels), NAMED)]
    _write(results, out, older(results) if stays.cases else {})
    rows, failing = text_rows(results["gates"])
    print_table(("case", "gate", "error", "tolerance", "status"), rows, failing)
    broken = [case for case in results["cases"] if case["failure"]]
    for case in broken:
        print(f"{case['name']} broke off: {case['failure']}")
    unread = [line for case in results["cases"] for line in unreadable(case)]
    print(*unread, sep="\n", end="\n" * bool(unread))
    print(origin(results["solves"]))
    print(f"{results['summary'][RowStatus.PASSED]} gates passed, {sum(failing)} failed: {out / INDEX}")
    return 1 if any(failing) or broken or unread else 0


def runnable(cases: Sequence[Case]) -> tuple[list[Case], dict[str, str]]:
    """The cases that can run here, and of the others, by name, why not; the reasons are printed."""
    unmet = {case.name: reason for case in cases if (reason := case.needs())}
    for name, reason in unmet.items():
        print(f"{name}: not run: {reason}")
    return [case for case in cases if case.name not in unmet], unmet


def rebuild(folder: Path, *, single_file: bool = False) -> int:
    """Write the pages of a finished report again from results.json and figures/, without solving.

    single_file: also report.html, which holds all of them and their figures. The index marks the
    cases that are older than the code.

    Returns 0. Raises FolderError when the folder holds no finished report.
    """
    results = finished(folder)
    print(write_report(results, folder, single_file=single_file, stale=older(results)))
    return 0


def problem_of(names: Sequence[str], known: dict[str, Case], out: Path) -> str:
    """What is wrong with the request, or an empty text."""
    if unknown := unknown_cases(names, known):
        return unknown
    if out.exists() and not out.is_dir():
        return f"{out} is not a folder: choose another with --out"
    if out.is_dir() and any(out.iterdir()) and stored(out) is None:
        return f"{out} holds files that are no verification report: choose an empty or new folder with --out"
    return ""


def finished(folder: Path) -> dict:
    """results.json of a finished report. Raises FolderError without one."""
    results = stored(folder)
    if results is None or not results.get("complete"):
        raise FolderError(
            f"{folder}: no finished verification report here ({RESULTS} is missing or incomplete)"
        )
    return results


def stored(folder: Path) -> dict | None:
    """results.json of a folder, None when there is none of ours."""
    try:
        results = json.loads((folder / RESULTS).read_text(encoding="utf-8"))
    except (OSError, ValueError):
        return None
    return results if isinstance(results, dict) and results.get("format") == FORMAT else None


def start(out: Path, stays: Earlier = NOTHING) -> None:
    """Mark the folder as a report in the making and clear an earlier one, but for the figures of
    what `stays` of it, which results.json goes on to hold.
    """
    out.mkdir(parents=True, exist_ok=True)
    _write_results({"format": FORMAT, "complete": False, BEFORE: before(out) if stays.cases else {}}, out)
    remove_pages(out)
    for name in ("gates.csv", "junit.xml"):
        (out / name).unlink(missing_ok=True)
    shutil.rmtree(out / "runs", ignore_errors=True)
    if not stays.files:
        shutil.rmtree(out / "figures", ignore_errors=True)
    for path in (out / "figures").glob("*"):
        if f"figures/{path.name}" not in stays.files:
            path.unlink()


def before(folder: Path) -> dict:
    """results.json of the finished report in a folder, or of the one that another is about to
    replace; empty without one.
    """
    results = stored(folder) or {}
    return results if results.get("complete") else results.get(BEFORE, {})


def _run(
    chosen: Sequence[Case], *, level: str, out: Path, progress: Progress, store: Store | None
) -> dict[str, RanCase]:
    """Run the cases one after the other; a case that breaks off does not stop the others."""
    ran: dict[str, RanCase] = {}
    for number, case in enumerate(chosen, start=1):
        progress(f"case {case.name}", number, len(chosen))
        ran[case.name] = _run_or_reuse(case, Context(case.name, out, level, progress, store=store))
    return ran


def _judged(ran: Mapping[str, RanCase], known: Mapping[str, Case], *, level: str, stays: Earlier) -> dict:
    """results.json, but for how it was asked for."""
    failures = {name: each.failure for name, each in ran.items()}
    asked = [row for case in known.values() if case.file for row in case.file.rows] or load_rows()
    verdicts = evaluate(asked, {name: each.outcome.values for name, each in ran.items()}, failures)
    inputs = {name: content for each in ran.values() for name, content in each.context.inputs.items()}
    gates = stays.among(_gate_record(verdict) for verdict in verdicts)
    collected = provenance.collect(inputs)
    return {
        "format": FORMAT,
        "complete": True,
        "level": level,
        "provenance": collected | {"input_sha256": stays.inputs | collected["input_sha256"]},
        "summary": {status: sum(gate["status"] == status for gate in gates) for status in RowStatus},
        "solves": _solves(list(ran.values())),
        "cases": [
            stays.cases.get(case.name) or _case_record(case, ran.get(case.name), verdicts)
            for case in known.values()
        ],
        "gates": gates,
    }


def _run_or_reuse(case: Case, context: Context) -> RanCase:
    """A case from the store, or else run and kept there, unless it measures times. What makes an
    entry unusable is said on stderr if it is damage.
    """
    started, kept = time.perf_counter(), None if case.alone else context.store
    found = outcomes.find(kept, case, context) if kept else Lookup()
    if found.result is not None:
        outcome = outcomes.put_back(found.result, context)
        source = Reuse(True, found.created, found.commit)
        return RanCase(context, outcome, "", found.result.seconds, source)
    outcome, failure = attempt(case, context)
    seconds = time.perf_counter() - started
    if kept and not failure:
        outcomes.keep(kept, case, context, outcome, seconds=seconds)
    for source in (note := Reuse(False, note=found.note)), *context.sources.values():
        if source.note.startswith("damaged"):
            print(f"samfem: {case.name}: {source.text}", file=sys.stderr, flush=True)
    return RanCase(context, outcome, failure, seconds, note)


def _solves(ran: Sequence[RanCase]) -> dict[str, int]:
    """Counts: runs solved and reused, entries that were not usable, and cases that were not run again."""
    runs = [source for each in ran for source in each.context.sources.values()]
    notes = [source.note for source in [*runs, *(each.source for each in ran)] if not source.reused]
    counts = {word: sum(note.startswith(word) for note in notes) for word in ("stale", "damaged")}
    reused = sum(source.reused for source in runs)
    return {
        "solved": len(runs) - reused,
        "reused": reused,
        "cases": sum(each.source.reused for each in ran),
        **counts,
    }


def attempt(case: Case, context: Context) -> tuple[Outcome, str]:
    """The outcome and, when the case broke off, why; any error of a case is its own and is reported
    with it. What was found before a figure failed counts.
    """
    try:
        return case.run(context), ""
    except NotDrawnError as lost:
        return lost.outcome, ""
    except Exception as problem:
        return Outcome(), context.told(problem)


def _case_record(case: Case, ran: RanCase | None, verdicts: Sequence[Verdict]) -> dict:
    """For results.json; ran: None for a case that was not chosen."""
    own = [verdict.status for verdict in verdicts if verdict.row.case == case.name]
    unread = ran is not None and any(figure.findings for figure in ran.outcome.figures)
    failed = ran is not None and (unread or bool(ran.failure) or any(status.red for status in own))
    reused = ran is not None and ran.source.reused
    return {
        "name": case.name,
        "title": case.title,
        "question": case.question,
        "equations": [list(row) for row in case.equations],
        "status": str((RowStatus.FAILED if failed else RowStatus.PASSED) if ran else RowStatus.NOT_RUN),
        "failure": ran.failure if ran else "",
        "seconds": ran.seconds if ran else None,
        "reused": asdict(ran.source) if reused else None,
        "code": version_of_cases() if ran else "",
        "inputs": dict(sorted(provenance.hashes(ran.context.inputs).items())) if ran else {},
        "runs": ran.context.runs if ran else [],
        "sources": _sources(ran.context) if ran else {},
        **{key: value for key, value in asdict(ran.outcome if ran else Outcome()).items() if key != "values"},
    }


def _sources(context: Context) -> dict[str, dict]:
    """Where the run in each folder is from, without the place of the store."""
    folders = [context.store.folder] if context.store else []
    return {
        run: asdict(source) | {"note": provenance.without_places(source.note, *folders)}
        for run, source in context.sources.items()
    }


def _gate_record(verdict: Verdict) -> dict:
    record = verdict.row.model_dump() | asdict(verdict)
    del record["row"]
    return plain(record)


def _write(results: dict, out: Path, stale: Mapping[str, str]) -> None:
    """results.json last: it is what makes the folder a finished report."""
    write_atomically(out / "gates.csv", gates_csv(results["gates"]).encode())
    write_atomically(out / "junit.xml", junit_xml(results["cases"], results["gates"]))
    write_report(results, out, stale=stale)
    _write_results(results, out)


def _write_results(results: dict, out: Path) -> None:
    write_atomically(out / RESULTS, results_json(results).encode())


def show(what: str, names: Sequence[str]) -> int:
    """On stdout, of the named cases (none: of all), one line each, or where `what` is "gates"
    question, gates, tolerances and reasons. Returns 0, or 2 for an unknown name.
    """
    known, gates, rows = all_cases(), load_rows(), []
    if problem := unknown_cases(names, known):
        print(f"samfem: error: {problem}", file=sys.stderr)
        return 2
    for case in [case for case in known.values() if not names or case.name in names]:
        own = [gate for gate in gates if gate.case == case.name]
        rows.append((case.name, ", ".join(case.levels) or "when named", str(len(own)), case.title))
        if what == "gates":
            print(f"{case.name}: {case.question}")
            for gate in own:
                print(f"  {gate.id}: {gate.quantity}: {_limit(gate)}")
                print(fill(gate.reason, WIDTH, initial_indent=" " * 6, subsequent_indent=" " * 6))
    if what != "gates":
        print("\n".join(table_lines(("case", "levels", "gates", "title"), rows)))
    return 0


def unknown_cases(names: Sequence[str], known: Mapping[str, Case]) -> str:
    """What is wrong with names of cases, or an empty text."""
    wrong = [name for name in names if name not in known]
    return unknown("case", wrong, known, "samfem verify --list shows all") if wrong else ""


def _limit(gate: Row) -> str:
    """What the gate allows, in words."""
    match gate.metric:
        case "equal":
            return "equal"
        case "at_most" | "at_least":
            return f"{gate.metric.replace('_', ' ')} {gate.tolerance:g}"
        case _:
            words = {"relative_l2": "relative difference (L2)"}.get(gate.metric, f"{gate.metric} difference")
            return f"{words} at most {gate.tolerance:g}"


def draw_pdf(folder: Path, progress: Progress, store: Store | None) -> list[Path]:
    """Write figures/<case>-<name>.pdf of every case of a report that has figures, and return the paths.

    A result that is not in the store is solved again. Raises FolderError when the folder holds no finished
    report.
    """
    results, known, written = finished(folder), all_cases(), []
    (folder / "figures").mkdir(exist_ok=True)
    for record in results["cases"]:
        if not record["figures"] or record["name"] not in known:
            continue
        with TemporaryDirectory() as scratch:
            out = Path(scratch)
            level = record.get("level", results["level"])
            context = Context(record["name"], out, level, progress, store=store, pdf=True)
            known[record["name"]].run(context)
            drawn = sorted((out / "figures").glob("*.pdf"))
            written += [Path(shutil.copy(path, folder / "figures" / path.name)) for path in drawn]
    return written
