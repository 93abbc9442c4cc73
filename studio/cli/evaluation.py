"""`evaluate` and `report`: the tables, and the page of those that were made."""

import logging
import sys
from collections.abc import Sequence

import tyro

from studio.cli.output import Answer, usage


def evaluate(argv: Sequence[str]) -> Answer:
    """`evaluate NAME`: the options are the table's own; others are bad usage."""
    from studio.evaluation.registry import TABLES, run_table, table

    lines = [f"  {name:<21}{about}" for name, about in TABLES.items()]
    overview = "\n".join(
        [
            "usage: a1-studio evaluate NAME [OPTIONS]",
            "",
            *lines,
            f"  {'all':<21}each of them",
            "",
            "a1-studio evaluate NAME --help lists a table's options.",
        ]
    )
    if not argv or argv[0] in ("-h", "--help"):
        usage(overview, 0 if argv else 2)
    name, rest = argv[0], argv[1:]
    if name not in (*TABLES, "all"):
        usage(f"no evaluation {name!r} is built\n\n{overview}", 2)
    chosen = table(name)
    if name == "all":
        logging.getLogger("studio.evaluation.all").setLevel(logging.INFO)  # its progress
    try:
        options = tyro.cli(chosen.options, prog=f"a1-studio evaluate {name}", args=rest)
    except SystemExit as stopped:
        if stopped.code == 2:
            takes = ", ".join(f"--{option.replace('_', '-')}" for option in chosen.takes)
            print(f"evaluate {name} takes {takes}", file=sys.stderr)
        raise
    return run_table(name, options)


def report(argv: Sequence[str]) -> Answer:
    """`report`: one page of what evaluate has made; `report pairs`: the mapper's table of seeds;
    `report baselines`: the rivals' page."""
    if argv[:1] == ["baselines"]:
        from studio.evaluation import baselines_report

        page = tyro.cli(baselines_report.Report, prog="a1-studio report baselines", args=argv[1:])
        return baselines_report.report(page)
    if argv[:1] == ["pairs"]:
        from studio.evaluation import pairs_report

        logging.getLogger("studio.evaluation").setLevel(logging.INFO)  # its progress
        config = tyro.cli(pairs_report.Report, prog="a1-studio report pairs", args=argv[1:])
        return pairs_report.report(config)
    from studio.evaluation.report import Report, make

    return make(tyro.cli(Report, prog="a1-studio report", args=argv))
