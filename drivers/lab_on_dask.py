#!/usr/bin/env python3
"""Tests many fabrics, in many directions, on the workers of a Dask cluster.

    python drivers/lab_on_dask.py kes-tensile fabrics/*/fabric.toml -- --by tile --direction weft --direction "30 deg"
    python drivers/lab_on_dask.py drape cards/*.toml --scheduler tcp://head:8786 -- --bending "0.05 gf cm^2/cm" --areal-mass "170 g/m^2"

`wale lab TEST --ask` prints a question for each fabric and direction, workers answer them with `wale lab --answer`, and
`wale lab TEST --tell` writes what the test would have written here. The program `wale` of the same version must be on every worker;
nothing else is: a question carries the card. A worker that is lost loses its question alone, which is asked again; an answer that comes
twice is taken once. Everything after `--` goes to `wale lab TEST`. Needs `dask` and `distributed`.
"""

import argparse
import sys

from fit_on_dask import call

ROUNDS = 5


def answer(wale, question):
    """Answers one question, on a worker."""
    return call([wale, "lab", "--answer", "--threads", "1"], question)


def lab(client, wale, test, fabrics, more=(), after_round=lambda count: None):
    """Tests; the number of rounds and of answers."""
    from dask.distributed import as_completed

    command = [wale, "lab", test, *map(str, fabrics), *more]
    told, rounds = [], 0
    while questions := call([*command, "--ask", "--tell", "-"], "".join(told)).splitlines():
        if rounds == ROUNDS:
            raise RuntimeError(f"{len(questions)} questions are not answered after {ROUNDS} rounds")
        futures = [client.submit(answer, wale, question, pure=False, retries=3) for question in questions]
        for future in as_completed(futures):
            try:
                told.append(future.result())
            except Exception as error:  # A worker that was lost: its question will be asked again.
                print(f"a question was not answered: {error}", file=sys.stderr)
        rounds += 1
        after_round(rounds)
    print(call([*command, "--tell", "-"], "".join(told)), end="")
    return rounds, len(told)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("test", help="name of the test")
    parser.add_argument("fabrics", nargs="+", help="fabric files, cards or scenes")
    parser.add_argument("--wale", default="wale", help="the program, as the workers find it")
    parser.add_argument("--scheduler", help="address of a scheduler; a cluster on this machine if left out")
    parser.add_argument("--workers", type=int, help="workers of that cluster")
    words = sys.argv[1:]
    cut = words.index("--") if "--" in words else len(words)
    arguments, more = parser.parse_args(words[:cut]), words[cut + 1 :]
    from dask.distributed import Client, LocalCluster

    cluster = arguments.scheduler or LocalCluster(n_workers=arguments.workers, threads_per_worker=1, dashboard_address=None)
    with Client(cluster) as client:
        rounds, answers = lab(client, arguments.wale, arguments.test, arguments.fabrics, more)
    print(f"{answers} answers in {rounds} rounds", file=sys.stderr)


if __name__ == "__main__":
    main()
