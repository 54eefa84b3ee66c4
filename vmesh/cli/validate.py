"""``vmesh validate``: everything that is wrong with a .vmesh file."""

from __future__ import annotations

import json
import sys
from dataclasses import asdict

import click

from vmesh.cli.limits import limit_options, take_limits
from vmesh.cli.streams import read_input
from vmesh.codec.validation import Severity, validate


@click.command("validate")
@click.argument("source", metavar="INPUT.vmesh")
@click.option("--json", "as_json", is_flag=True, help="Print the findings as JSON.")
@limit_options
def command(source: str, as_json: bool, **options: int) -> None:
    """Check a .vmesh file and say all that is wrong with it.

    The status is 0 if the file conforms and 1 if it does not. Each finding has a stable code, from
    section 12 of the specification.
    """
    findings = validate(read_input(source), limits=take_limits(options))
    errors = [finding for finding in findings if finding.severity is Severity.ERROR]
    if as_json:
        report = {"valid": not errors, "findings": [asdict(finding) for finding in findings]}
        click.echo(json.dumps(report))
    else:
        for finding in findings:
            where = "" if finding.offset is None else f" at byte {finding.offset}"
            click.echo(f"{source}: {finding.severity} {finding.code}{where}: {finding.message}")
        if not errors:
            click.echo(f"{source}: valid")
    if errors:
        sys.exit(1)
