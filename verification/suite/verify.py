# SPDX-License-Identifier: MIT
"""Run verification cases, judge them by the table of gates, and write the report; or list them, or
draw the figures of a report as PDF.

The folder holds the pages (index.html and one for each group of cases), results.json, gates.csv,
junit.xml, figures/ and runs/ (every solve). While the cases run all of this stands in unfinished/ in it, with
pages of the cases that ended and "complete": false in results.json; it takes the place of an earlier report
when it is whole.
"""

import json
import shutil
import sys
import time
from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass
from pathlib import Path
from tempfile import TemporaryDirectory
from textwrap import fill
from typing import Any

from sam.scene import Progress as Told, printable
from verification.cases import Case, all_cases, case_of
from verification.cases.case import Context, NotDrawnError, Outcome
from verification.judging import Row, RowStatus, Verdict, evaluate
from verification.rows import load_rows, read_cases
from verification.runs import provenance
from verification.runs.code_version import version_of_cases
from verification.runs.files import FULL, FolderError, check_place, plain, write_atomically
from verification.runs.lock import locked
from verification.runs.store import Lookup, Reuse, Store
from verification.suite import outcomes
from verification.suite.forecast import forecast
from verification.suite.freshness import Earlier, older
from verification.suite.pages import INDEX, remove_pages, write_report
from verification.suite.pages.stored import ASKED, ELSEWHERE, NAMED, WAITS
from verification.suite.records import gates_csv, junit_xml, origin, results_json, text_rows, unreadable
from verification.text.console import Progress, print_table, table_lines, unknown
from verification.text.readable import with_time

FORMAT = "samfem-verification"
RESULTS = "results.json"
NOTHING = Earlier()
WIDTH = 100
"""Characters of a line of a reason."""
UNFINISHED = "unfinished"
"""Folder in that of a report: the next one, while it is made."""
SHARE = 0.02
"""Of the time, at most, for pages that the last ones replace."""


@dataclass(frozen=True)
class RanCase:
    """A case, run or reused. failure: why it broke off; source: where it is from, or why not reused."""

    context: Context
    outcome: Outcome
    failure: str
    seconds: float
    source: Reuse


def main(cases: list[str], level: str, out: Path, *, store: Store | None = None) -> int:
    """Run the named cases (none: all of the level), or take them from the store, and write the report into
    `out`. A name that ends with .toml is a file of own cases, which then are all that there are. Returns 0
    when every gate of every case that ran held and its figures can be read, 1 when not, 2 for an unknown case
    or a folder that holds something else (nothing is written then). An earlier report in `out` is replaced
    when the new one is whole. A case that needs what is not there is not run, with the reason; if that is so
    for all, nothing is written.
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
    words = " ".join(["samfem verify", *cases, "--level", level])  # where to is the reader's
    asked = {"level": level, "command": words, "unmet": unmet}
    with locked(out):
        begin(out)
        ran = _run(chosen, known, out=out, store=store, **asked)
        return finish(ran, known, out=out, **asked)


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
    """Judge the cases that ran, whose files are in UNFINISHED, put the report of them into the place of the
    earlier one and say what is red. known: all cases by name; unmet: name -> why a case could not run here;
    stays: of the earlier report. Returns 0 when every gate of every case that ran held, else 1.
    """
    results = _judged(ran, known, level=level, command=command, unmet=unmet, stays=stays)
    _write(results, out / UNFINISHED, older(results) if stays.cases else {}, place=out)
    _take_over(out)
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
    """What is wrong with the request, or an empty text. Raises FolderError for a place without a folder."""
    if unknown := unknown_cases(names, known):
        return unknown
    check_place(out)
    new = out / UNFINISHED
    if new.is_dir() and any(new.iterdir()):
        ours = stored(new) is not None
    else:
        ours = stored(out) is not None or not out.is_dir() or {*out.iterdir()} <= {new}
    if not ours:
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


def begin(out: Path) -> Path:
    """UNFINISHED in `out`, for a report in the making; a whole one left there takes its place first."""
    new = out / UNFINISHED
    if (stored(new) or {}).get("complete"):
        _take_over(out)
    shutil.rmtree(new, ignore_errors=True)
    new.mkdir(parents=True)
    _write_results({"format": FORMAT, "complete": False}, new)
    return new


def _take_over(out: Path) -> None:
    """Put the report in UNFINISHED into its place, results.json last; broken off, a next call goes on."""
    if (out / RESULTS).exists():
        remove_pages(out)
        for name in ("runs", "figures"):
            shutil.rmtree(out / name, ignore_errors=True)
        for name in ("gates.csv", "junit.xml", RESULTS):
            (out / name).unlink(missing_ok=True)
    for path in sorted((out / UNFINISHED).iterdir(), key=lambda path: path.name == RESULTS):
        path.replace(out / path.name)
    (out / UNFINISHED).rmdir()


def before(folder: Path) -> dict:
    """results.json of the finished report in a folder; empty without one."""
    results = stored(folder) or {}
    return results if results.get("complete") else {}


def _run(
    chosen: Sequence[Case], known: Mapping[str, Case], *, out: Path, store: Store | None, **asked: Any
) -> dict[str, RanCase]:
    """Run the cases one after the other, with a line and pages as each ends. asked: as for `_judged`."""
    ran: dict[str, RanCase] = {}
    new, count, rows, due = out / UNFINISHED, len(chosen), _rows(known), 0.0
    ahead = forecast(chosen, asked["level"], store)
    own = sum(row.case in ahead.needs for row in rows)
    print(f"{count} case{'s' * (count > 1)} with {own} of the {len(rows)} gates, {asked['level']} level.")
    print(ahead.words)
    print(f"Pages of the cases that have ended: {new / INDEX}; the whole report: {out / INDEX}")
    if count > 1:
        print("To run less, name cases: make report CASES=hertz-sphere, or samfem verify hertz-sphere")
    sys.stdout.flush()
    try:
        with Progress() as progress:
            for number, case in enumerate(chosen, start=1):

                def told(stage: str, done: int, total: int, place: str = f"case {number} of {count}") -> None:
                    progress(f"{place}: {stage}", done, total, ahead.left)

                told(case.name, 0, 0)
                context = Context(case.name, new, asked["level"], told, store=store)
                ran[case.name] = _run_or_reuse(case, context)
                ahead.ended(case.name)
                print(f"{number} of {count}: {_line(ran[case.name], rows)}", flush=True)
                began = time.monotonic()
                if number < count and began >= due:
                    unmet = asked["unmet"] | {each.name: WAITS for each in chosen[number:]}
                    results = _judged(ran, known, **asked | {"unmet": unmet})
                    running = {"complete": False, "running": f"{number} of {count} cases finished"}
                    _write(results | running, new)
                    due = began + (time.monotonic() - began) / SHARE
    except KeyboardInterrupt:
        pages = f", pages in {new / INDEX}" if (new / INDEX).exists() else ""
        goes_on = "goes on" if store else "begins anew, without a store"
        raise KeyboardInterrupt(
            f"interrupted: {len(ran)} of {count} cases have ended{pages}; the same command {goes_on}"
        ) from None
    return ran


def _line(ran: RanCase, rows: Sequence[Row]) -> str:
    """What a case found, in a line."""
    name = ran.context.case
    own = [row for row in rows if row.case == name]
    verdicts = evaluate(own, {name: ran.outcome.values}, {name: ran.failure})
    red = sum(verdict.status.red for verdict in verdicts)
    held = len(verdicts) - red
    found = f"{held} gate{'s' * (held != 1)} passed{f', {red} failed' * bool(red)}"
    unread = ", a figure cannot be read" * any(figure.findings for figure in ran.outcome.figures)
    broke = f", broke off: {ran.failure}" * bool(ran.failure)
    took = "from the store" if ran.source.reused else with_time(ran.seconds)
    return printable(f"{name}: {found}{unread}{broke}, {took}")


def _rows(known: Mapping[str, Case]) -> Sequence[Row]:
    """The rows of own cases, or the table of all."""
    return [row for case in known.values() if case.file for row in case.file.rows] or load_rows()


def _judged(
    ran: Mapping[str, RanCase],
    known: Mapping[str, Case],
    *,
    level: str,
    command: str,
    unmet: Mapping[str, str],
    stays: Earlier = NOTHING,
) -> dict:
    """results.json. Of the cases that did not run it says under `unmet` where they belong."""
    failures = {name: each.failure for name, each in ran.items()}
    verdicts = evaluate(_rows(known), {name: each.outcome.values for name, each in ran.items()}, failures)
    inputs = {name: content for each in ran.values() for name, content in each.context.inputs.items()}
    records = (verdict.row.model_dump() | asdict(verdict) for verdict in verdicts)
    gates = stays.among(plain({name: each[name] for name in each if name != "row"}) for each in records)
    collected = provenance.collect(inputs)
    cases = []
    for case in known.values():
        record = stays.cases.get(case.name) or _case_record(case, ran.get(case.name), verdicts)
        why = unmet.get(case.name, "")
        if record["status"] == RowStatus.NOT_RUN and not why:
            why = ELSEWHERE[ASKED if level in case.levels else next(iter(case.levels), NAMED)]
        cases.append({**record, "unmet": why})
    return {
        "format": FORMAT,
        "complete": True,
        "level": level,
        "provenance": collected | {"input_sha256": stays.inputs | collected["input_sha256"]},
        "summary": {status: sum(gate["status"] == status for gate in gates) for status in RowStatus},
        "solves": _solves(list(ran.values())),
        "cases": cases,
        "gates": gates,
        "command": command,
    }


def _run_or_reuse(case: Case, context: Context) -> RanCase:
    """A case from the store, or run and kept there, unless it measures times. Damage is said on stderr."""
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
    """The outcome and, when the case broke off, why. Any error of a case but a full disk is reported with it;
    what was found before a figure failed counts.
    """
    try:
        return case.run(context), ""
    except NotDrawnError as lost:
        return lost.outcome, ""
    except Exception as problem:
        if isinstance(problem, OSError) and problem.errno in FULL:
            raise
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
        "file": outcomes.file_digest(case) if ran else "",
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


def _write(
    results: dict, folder: Path, stale: Mapping[str, str] | None = None, place: Path | None = None
) -> None:
    """results.json last: it is what makes the folder a finished report. place: where it will stand."""
    write_atomically(folder / "gates.csv", gates_csv(results["gates"]).encode())
    write_atomically(folder / "junit.xml", junit_xml(results["cases"], results["gates"]))
    write_report(results, folder, stale=stale, place=place)
    _write_results(results, folder)


def _write_results(results: dict, out: Path) -> None:
    write_atomically(out / RESULTS, results_json(results).encode())


def show(what: str, names: Sequence[str]) -> int:
    """A line for each named case (none: all), or its gates with reasons. 0, or 2 for an unknown name."""
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


def draw_pdf(folder: Path, progress: Told, store: Store | None) -> list[Path]:
    """Write figures/<case>-<name>.pdf of every case of a report that has figures, and return the paths. A
    result that is not in the store is solved again. Raises FolderError when the folder holds no finished
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
