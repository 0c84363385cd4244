#!/usr/bin/env python3
"""Fits the yarn of a fabric on the workers of a Ray cluster: as `fit_on_dask.py`, which says how.

    python drivers/fit_on_ray.py fabric.toml --out fit [--address auto] [-- --way swarm]
"""

import argparse
import pathlib
import sys

import ray

from fit_on_dask import answer, call


def answered(references):
    """The answers that came; a question of which none did is asked again in the next round."""
    for reference in references:
        try:
            yield ray.get(reference)
        except ray.exceptions.RayError as error:
            print(f"a question was not answered: {error}", file=sys.stderr)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("fabric", type=pathlib.Path)
    parser.add_argument("--out", type=pathlib.Path, required=True)
    parser.add_argument("--wale", default="wale")
    parser.add_argument("--address", help="of a Ray cluster; one on this machine if left out")
    arguments, more = parser.parse_known_args()
    ray.init(address=arguments.address)
    task = ray.remote(max_retries=3)(answer)
    more = [word for word in more if word != "--"]
    command = [arguments.wale, "fit", str(arguments.fabric), "--out", str(arguments.out), *more]
    while questions := call([*command, "--ask"]).splitlines():
        problem = ray.put((arguments.out / "problem.json").read_text())
        told = list(answered([task.remote(arguments.wale, problem, question) for question in questions]))
        if not told:
            raise RuntimeError("no worker answers")
        call([*command, "--tell", "-"], "".join(told))
    print(call(command), end="")


if __name__ == "__main__":
    main()
