"""A Dask cluster of two workers, run as a program: it prints its address, then the workers' ids.

It ends when its standard input does.
"""

from __future__ import annotations

import os
import sys

from distributed import Client, LocalCluster


def main() -> None:
    """Run the cluster."""
    with (
        LocalCluster(n_workers=2, threads_per_worker=1, dashboard_address=None) as cluster,
        Client(cluster) as client,
    ):
        print(cluster.scheduler_address, *client.run(os.getpid).values(), flush=True)
        sys.stdin.read()


if __name__ == "__main__":
    main()
