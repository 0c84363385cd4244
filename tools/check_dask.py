#!/usr/bin/env python3
"""A fit on a Dask cluster of this machine, one worker of which is lost on the way, gives the card that the program alone gives; and tests
of that card give the files.

python tools/check_dask.py WALE FABRIC.toml FOLDER
"""

import os
import pathlib
import shutil
import signal
import sys

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent.parent / "drivers"))

from dask.distributed import Client, LocalCluster
from fit_on_dask import call, fit
from lab_on_dask import lab


def main():
    wale, fabric, folder = sys.argv[1], sys.argv[2], pathlib.Path(sys.argv[3])
    shutil.rmtree(folder, ignore_errors=True)
    folder.mkdir(parents=True)
    call([wale, "fit", fabric, "--out", str(folder / "alone"), "--quick"])
    with LocalCluster(n_workers=2, threads_per_worker=1, dashboard_address=None) as cluster, Client(cluster) as client:

        def lose_a_worker(rounds):
            if rounds == 1:
                lost = next(iter(client.run(os.getpid).values()))
                os.kill(lost, signal.SIGKILL)
                print(f"worker {lost} is lost")

        rounds, answers = fit(client, wale, fabric, folder / "dask", ["--quick"], lose_a_worker)
        card, tested = str(folder / "alone" / "card.toml"), ["kes-tensile", "--direction", "weft", "--direction", "warp"]
        call([wale, "lab", *tested, card, "--out", str(folder / "lab-alone")])
        lab(client, wale, tested[0], [card], [*tested[1:], "--out", str(folder / "lab-dask")])
    alone, together = [(folder / name / "card.toml").read_text() for name in ("alone", "dask")]
    assert alone == together, "the cards differ"
    for suffix in ("csv", "svg"):
        alone, together = [(folder / name / f"kes-tensile.{suffix}").read_text() for name in ("lab-alone", "lab-dask")]
        assert alone == together, f"kes-tensile.{suffix} differs"
    print(f"{answers} answers in {rounds} rounds give the same card")


if __name__ == "__main__":
    main()
