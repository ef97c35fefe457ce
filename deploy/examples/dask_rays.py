#!/usr/bin/env python3
"""Asks many rays through Dask's workers, on one machine or many, and says whether the answers are those of one process.

    dask_rays.py --rays 10000000 --workers 3 --domains 201,202,203 --check
    dask_rays.py --rays 10000000 --workers 2 --snapshot now.cscene

Every worker asks a server near it: worker number i the one on the i-th domain of the list, over again from the first
where there are more workers. The servers must hold the same scene; --check finds out whether they answer alike, to the
last bit. With --snapshot every worker starts a server of its own on that file (collide snapshot), and ends it; --check
then compares with the server on the first domain. With --scheduler the workers are those of a running Dask cluster.

Needs the packages python3-distributed and python3-numpy.
"""

from __future__ import annotations

import argparse
import hashlib
import os
import subprocess
import sys
import tempfile
import time

import numpy as np
from dask.distributed import Client, LocalCluster, as_completed, get_worker

import collided

CHUNK = 100_000  # rays of one request, the most that a server takes


def rays_of(seed: int, chunk: int, count: int) -> tuple[np.ndarray, np.ndarray]:
    """Origins and directions of a chunk: the same wherever and whenever they are made."""
    random = np.random.Generator(np.random.Philox(key=[seed, chunk]))
    origins = random.uniform((-10, -10, 0), (10, 10, 5), (count, 3))
    return origins, random.uniform(-1, 1, (count, 3))


def answer(server: collided.Client, seed: int, chunk: int, count: int) -> tuple[int, bytes]:
    """How many rays of a chunk hit, and a digest of all verdicts, distances and triangles to the last bit."""
    answers = server.rays(*rays_of(seed, chunk, count), timeout=60)
    digest = hashlib.sha256()
    for column in (answers.verdict, answers.distance, answers.error, answers.triangle):
        digest.update(np.ascontiguousarray(column).tobytes())
    return int(answers.is_hit().sum()), digest.digest()


def served_here(snapshot: str, domain: int, folder: str) -> collided.Client:
    """A server on the snapshot for this process alone, which ends with it."""
    name = f"batch_{os.getpid()}"
    served = ["collided", "--namespace", name, "--domain", str(domain), "--threads", "1", "--state-dir", folder, snapshot]
    # Linux ends it even if the worker is killed.
    subprocess.Popen(["setpriv", "--pdeathsig", "TERM", *served], stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    return collided.connect(domain=domain, name_space=name, wait=60)


def on_worker(domains: list[int], snapshot: str | None, seed: int, chunk: int, count: int) -> tuple[int, int, bytes]:
    """The same on a worker, whose connection stays open from chunk to chunk."""
    worker = get_worker()
    if not hasattr(worker, "collided_client"):
        number = int(worker.name) if str(worker.name).isdigit() else abs(hash(worker.address))
        domain = domains[number % len(domains)]
        if snapshot:
            worker.collided_folder = tempfile.TemporaryDirectory(prefix="collided_batch_")
            worker.collided_client = served_here(snapshot, domain, worker.collided_folder.name)
        else:
            worker.collided_client = collided.connect(domain=domain)
    return (chunk, *answer(worker.collided_client, seed, chunk, count))


def whole(digests: list[bytes]) -> str:
    return hashlib.sha256(b"".join(digests)).hexdigest()[:16]


def parse() -> argparse.Namespace:
    parser = argparse.ArgumentParser(description="Many rays through Dask's workers.")
    parser.add_argument("--rays", type=int, default=1_000_000, help="how many")
    parser.add_argument("--seed", type=int, default=1, help="of the rays")
    parser.add_argument("--workers", type=int, default=3, help="processes of this machine, without --scheduler")
    parser.add_argument("--scheduler", help="address of a running cluster, such as tcp://10.0.0.1:8786")
    parser.add_argument("--domains", default="0", help="DDS domains of the servers, such as 201,202,203")
    parser.add_argument("--snapshot", help="file that every worker serves for itself, in place of servers on the domains")
    parser.add_argument("--check", action="store_true", help="ask all again from this process and compare")
    options = parser.parse_args()
    if options.rays < 1 or options.workers < 1:
        parser.error("--rays and --workers: 1 or more")
    return options


def main() -> int:
    options = parse()
    snapshot = os.path.abspath(options.snapshot) if options.snapshot else None
    domains = [int(domain) for domain in options.domains.split(",")]
    chunks = [(i, min(CHUNK, options.rays - i * CHUNK)) for i in range((options.rays + CHUNK - 1) // CHUNK)]
    cluster = None if options.scheduler else LocalCluster(
        n_workers=options.workers, threads_per_worker=1, host="127.0.0.1", dashboard_address=None
    )
    try:
        with Client(options.scheduler or cluster) as dask:
            began = time.monotonic()
            asked = [dask.submit(on_worker, domains, snapshot, options.seed, *chunk, pure=False) for chunk in chunks]
            hits, digests = 0, [b""] * len(chunks)
            for done, (_, (chunk, found, digest)) in enumerate(as_completed(asked, with_results=True), 1):
                hits, digests[chunk] = hits + found, digest
                if sys.stderr.isatty():
                    print(f"\r{done} of {len(chunks)} chunks", end="", file=sys.stderr)
            took = time.monotonic() - began
    finally:
        if cluster is not None:
            cluster.close()
    print(f"{options.rays} rays, {hits} hits, {took:.1f} s, {options.rays / took:.0f} rays/s, digest {whole(digests)}")
    if not options.check:
        return 0
    with collided.connect(domain=domains[0]) as server:
        began = time.monotonic()
        alone = [answer(server, options.seed, *chunk)[1] for chunk in chunks]
        took = time.monotonic() - began
    is_same = alone == digests
    print(f"one process: {took:.1f} s, digest {whole(alone)}: {'the same bits' if is_same else 'NOT the same'}")
    return 0 if is_same else 1


if __name__ == "__main__":
    sys.exit(main())
