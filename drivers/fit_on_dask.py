#!/usr/bin/env python3
"""Fits the yarn of a fabric on the workers of a Dask cluster.

    python drivers/fit_on_dask.py fabrics/acrylic-stockinette/fabric.toml --out fit
    python drivers/fit_on_dask.py fabric.toml --scheduler tcp://head:8786 -- --way swarm

`wale fit --ask` says which questions the fit has now, workers answer them with `wale fit --answer`, and `wale fit --tell` takes the
answers, until there are no more questions. The program `wale` must be on every worker; nothing else is: the problem travels with the
questions. A worker that is lost loses its question alone, which is asked again; an answer that comes twice is taken once.
Everything after `--` goes to `wale fit`: options, and other fabrics of the same yarn. Needs `dask` and `distributed`.
"""

import argparse
import hashlib
import pathlib
import subprocess
import sys
import tempfile


def call(command, text=""):
    """Output of a command; what it says goes to standard error."""
    done = subprocess.run(command, input=text, stdout=subprocess.PIPE, text=True, check=False)
    if done.returncode:
        raise RuntimeError(f"{' '.join(command)} ended with {done.returncode}")
    return done.stdout


def answer(wale, problem, question):
    """Answers one question, on a worker, in a folder that holds the problem."""
    name = hashlib.sha256(problem.encode()).hexdigest()[:16]
    folder = pathlib.Path(tempfile.gettempdir()) / f"wale-fit-{name}"
    folder.mkdir(exist_ok=True)
    written = folder / "problem.json"
    if not written.exists():
        # Under another name first: workers of one machine share the folder.
        with tempfile.NamedTemporaryFile("w", dir=folder, delete=False) as file:
            file.write(problem)
        pathlib.Path(file.name).replace(written)
    return call([wale, "fit", "elsewhere.toml", "--out", str(folder), "--answer", "--threads", "1"], question)


def fit(client, wale, fabric, out, more=(), after_round=lambda count: None):
    """Fits; the number of rounds and of answers."""
    from dask.distributed import as_completed

    command = [wale, "fit", str(fabric), "--out", str(out), *more]
    rounds = answers = 0
    while True:
        questions = call([*command, "--ask"]).splitlines()
        if not questions:
            break
        # With each question, and not scattered: what is scattered is lost with the worker that holds it, and scattering fails while one goes.
        problem = (pathlib.Path(out) / "problem.json").read_text()
        futures = [client.submit(answer, wale, problem, question, pure=False, retries=3) for question in questions]
        told = []
        for future in as_completed(futures):
            try:
                told.append(future.result())
            except Exception as error:  # A worker that was lost: its question will be asked again.
                print(f"a question was not answered: {error}", file=sys.stderr)
        if not told:
            raise RuntimeError("no worker answers")
        call([*command, "--tell", "-"], "".join(told))
        rounds += 1
        answers += len(told)
        after_round(rounds)
    print(call(command), end="")
    return rounds, answers


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("fabric", type=pathlib.Path)
    parser.add_argument("--out", type=pathlib.Path, help="folder of the fit; beside the fabric file if left out")
    parser.add_argument("--wale", default="wale", help="the program, as the workers find it")
    parser.add_argument("--scheduler", help="address of a scheduler; a cluster on this machine if left out")
    parser.add_argument("--workers", type=int, help="workers of that cluster")
    arguments, more = parser.parse_known_args()
    more = [word for word in more if word != "--"]
    from dask.distributed import Client, LocalCluster

    out = arguments.out or arguments.fabric.with_suffix(".fit")
    cluster = arguments.scheduler or LocalCluster(n_workers=arguments.workers, threads_per_worker=1, dashboard_address=None)
    with Client(cluster) as client:
        rounds, answers = fit(client, arguments.wale, arguments.fabric, out, more)
    print(f"{answers} answers in {rounds} rounds", file=sys.stderr)


if __name__ == "__main__":
    main()
