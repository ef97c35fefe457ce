#!/usr/bin/env python3
"""Whether two files of `collide watch --json` say the same of each pair, in the same order, as far as both go.

    same_events.py ALONE FLEET

When the two were ended need not be the same moment, so the last of each pair may be missing in one; much more may not. Exits 1
where a pair is told otherwise, or an event is told twice or out of order.
"""
import collections
import json
import sys

# Of one pair: what two passes of a recording have, at most.
MOST_MISSING = 160


def by_pair(path):
    pairs = collections.defaultdict(list)
    last = (0, 0)
    backwards = 0
    with open(path, encoding="utf-8") as lines:
        for line in lines:
            event = json.loads(line)
            here = (event["epoch"], event["sequence"])
            backwards += here <= last
            last = here
            pairs[event["a"], event["b"]].append((event["what"], event.get("why")))
    for told in pairs.values():
        # Who was still in contact when the publishers ended was removed then.
        if told[-1][1] in ("removed", "publisher_lost"):
            told.pop()
    return pairs, backwards


def main():
    (alone, _), (fleet, backwards) = by_pair(sys.argv[1]), by_pair(sys.argv[2])
    events = sum(map(len, fleet.values()))
    differing = 0
    for pair in sorted(alone.keys() | fleet.keys()):
        one, other = alone[pair], fleet[pair]
        common = min(len(one), len(other))
        if one[:common] == other[:common] and max(len(one), len(other)) - common <= MOST_MISSING:
            continue
        differing += 1
        at = next((i for i in range(common) if one[i] != other[i]), common)
        print(f"{pair}: {len(one)} events alone, {len(other)} of the fleet; the {at + 1}th is {one[at:at + 1]} and {other[at:at + 1]}")
    print(f"{events} events of {len(fleet)} pairs: {differing} pairs told otherwise, {backwards} events twice or out of order")
    sys.exit(1 if differing or backwards or not events else 0)


main()
