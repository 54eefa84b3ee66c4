"""``vmesh validate``: everything that is wrong with a .vmesh file."""

from __future__ import annotations

import json
import sys
from dataclasses import asdict

import click

from vmesh.cli.jobs import run_inputs
from vmesh.cli.limits import limit_options, take_limits
from vmesh.cli.streams import read_input, tell
from vmesh.codec.validation import Severity, validate
from vmesh.errors import shown


@click.command("validate")
@click.argument("sources", metavar="INPUT.vmesh...", nargs=-1, required=True)
@click.option("--json", "as_json", is_flag=True, help="Print the findings as JSON.")
@limit_options
def command(sources: tuple[str, ...], as_json: bool, **options: int) -> None:
    """Check .vmesh files and say all that is wrong with them.

    Folders are searched for .vmesh files. The status is 0 if all files conform and 1 if one does
    not. Each finding has a stable code, from section 12 of the specification. Of several files
    each has a line of JSON with its source.
    """
    limits, wrong = take_limits(options), set[str]()

    def work(source: str, heading: str) -> None:
        findings = validate(read_input(source), limits=limits)
        is_valid = all(finding.severity is not Severity.ERROR for finding in findings)
        if not is_valid:
            wrong.add(source)
        if as_json:
            report = {"valid": is_valid, "findings": [asdict(finding) for finding in findings]}
            tell(json.dumps({"source": source} | report if heading else report))
            return
        for finding in findings:
            where = "" if finding.offset is None else f" at byte {finding.offset}"
            tell(f"{shown(source)}: {finding.severity} {finding.code}{where}: {finding.message}")
        if is_valid:
            tell(f"{shown(source)}: valid")

    run_inputs(sources, work)
    if wrong:
        sys.exit(1)
