"""Run every benchmark and print the figures; ``--short`` runs those with a peer in the same run, smaller."""

from __future__ import annotations

import sys

from plcgen.__main__ import collect_rarely
from tests.bench import (
    codec,
    diff_speed,
    editing,
    generation,
    layout_speed,
    plants,
    ppi,
    scale,
    scans,
    scl_speed,
    simaticml_reading,
    startup,
    work_memory,
)


def main(*, short: bool = False) -> None:
    """Print the figures of this machine, with the garbage collector set as the command line sets it."""
    collect_rarely()
    jobs = 100 if short else 1000
    ours, bare, ratio = generation.ratio(jobs)
    print(f"generation of {jobs:,} jobs against the same templates in bare Jinja2")
    print(f"  plcgen {ours:.2f} s   Jinja2 {bare:.2f} s   ratio {ratio:.2f}   goal <= {generation.GOAL}")
    ours, bare, ratio, speed = generation.code(20 if short else 100)
    print("SimaticML of code blocks from SCL text against bare Jinja2 that writes the same, finished elements")
    print(f"  plcgen {ours:.2f} s   Jinja2 {bare:.2f} s   ratio {ratio:.2f}   goal <= 1   {speed:.0f} MB/s")
    fast, plain = codec.rates(0.3 if short else 1)
    print("codec round trips of three seed telegrams")
    print(f"  codec {fast:,.0f}/s   struct alone {plain:,.0f}/s   ratio {plain / fast:.1f}   goal <= {codec.GOAL}")
    print("start-up, whole processes, medians of CPU time")
    for row in startup.table(3 if short else 11):
        print(f"  {row}")
    editing.main(short=short)
    scans.main()
    if short:
        scale.main((100,))
        return
    print("growth, files written to disk")
    rows = generation.growth()
    for jobs, seconds, memory, files in rows:
        per = seconds / jobs * 1000
        print(f"  {jobs:>6} jobs   {seconds:7.2f} s   {per:5.2f} ms/job   {memory:6.0f} MiB   {files} files")
    (_, first, _, _), (_, last, _, _) = rows[-2], rows[-1]
    print(f"  10 times the jobs take {last / first:.1f} times as long")
    scl_speed.main()
    ppi.main()
    simaticml_reading.main()
    layout_speed.main()
    diff_speed.main()
    work_memory.main()
    plants.main()
    scale.main()


if __name__ == "__main__":
    main(short="--short" in sys.argv)
