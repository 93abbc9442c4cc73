"""`train`, `publish` and `export`: weights made, scored and shipped, handed to other programs."""

import logging
from collections.abc import Sequence

import tyro

from studio.cli.output import Answer, usage


def train(argv: Sequence[str]) -> Answer:
    kinds = {"mapper": _mapper, "policy": _policy}
    if not argv or argv[0] not in kinds:
        usage(f"a1-studio train {'|'.join(kinds)} [--help]", 0 if "--help" in argv else 2)
    from studio.training import parent_watch

    parent_watch.exit_with_parent()
    return kinds[argv[0]](argv[1:])


def _mapper(argv: Sequence[str]) -> Answer:
    if any(arg.partition("=")[0] in ("--takes", "--dataset") for arg in argv):
        from studio.training.collected import TakesTraining, run_train_takes

        return run_train_takes(tyro.cli(TakesTraining, prog="a1-studio train mapper", args=argv))
    from studio.training.mapper_fit import MapperTraining
    from studio.training.train_mapper import run_train_mapper

    return run_train_mapper(tyro.cli(MapperTraining, prog="a1-studio train mapper", args=argv))


def _policy(argv: Sequence[str]) -> Answer:
    from studio.training.policy_settings import PolicyTraining
    from studio.training.train_policy import run_train_policy

    logging.getLogger("studio.training.train_policy").setLevel(logging.INFO)  # its progress
    return run_train_policy(tyro.cli(PolicyTraining, prog="a1-studio train policy", args=argv))


def publish(argv: Sequence[str]) -> Answer:
    from studio.evaluation.publish import Publish
    from studio.evaluation.publish import publish as score_and_ship

    return score_and_ship(tyro.cli(Publish, prog="a1-studio publish", args=argv))


def export(argv: Sequence[str]) -> Answer:
    if not argv or argv[0] != "policy":
        usage("usage: a1-studio export policy [--help]", 0 if "--help" in argv else 2)
    from studio.training.export import PolicyExport, run_export_policy

    return run_export_policy(tyro.cli(PolicyExport, prog="a1-studio export policy", args=argv[1:]))
