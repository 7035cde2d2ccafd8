"""Islands: evolutions on the workers of a Ray cluster, which exchange their creatures.

    python islands.py [--islands 4] [--rounds 6] [--address ADDRESS]

Every island evolves with a seed of its own. After each round it takes the creatures of the island before it that are fitter than its
own of the same kind. The same seed gives the same champion, however many workers there are. Needs `pip install 'rockfall[ray]'`.
"""

from __future__ import annotations

import argparse
from typing import Any

import ray

import rockfall as rf


@ray.remote(num_cpus=1, max_restarts=0)
class Island:
    """An evolution on a worker."""

    def __init__(self, **options: Any) -> None:
        self.evolution = rf.Evolution(**options)

    def run(self, generations: int) -> rf.Evolution:
        """Runs generations, and returns the evolution as it is then."""
        self.evolution.run(generations)
        return self.evolution

    def adopt(self, other: rf.Evolution) -> int:
        """Takes fitter creatures of another island."""
        return self.evolution.adopt(other)


def islands(count: int, rounds: int, *, generations: int = 5, seed: int = 1, **options: Any) -> list[rf.Evolution]:
    """Evolves on several islands, with an exchange after every round but the last. Returns the evolutions."""
    actors = [Island.remote(seed=seed + number, backend="cpu", **options) for number in range(count)]
    for number in range(rounds):
        # References, so that creatures travel from worker to worker.
        states = [actor.run.remote(generations) for actor in actors]
        if number + 1 < rounds:
            ray.get([actor.adopt.remote(states[place - 1]) for place, actor in enumerate(actors)])
    return ray.get(states)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--islands", type=int, default=4)
    parser.add_argument("--rounds", type=int, default=6)
    parser.add_argument("--address", help="address of a Ray cluster; by default, this machine")
    arguments = parser.parse_args()
    ray.init(address=arguments.address, include_dashboard=False)
    found = islands(arguments.islands, arguments.rounds, population=64, seconds=5.0)
    champions = [evolution.champion for evolution in found]
    for number, champion in enumerate(champions):
        print(f"island {number}: " + ("no champion" if champion is None else f"{champion.fitness:.2f} units"))
    best = max((champion for champion in champions if champion is not None), key=lambda champion: champion.fitness, default=None)
    if best is not None:
        best.scene.save("islands.txt")
        print("written islands.txt: rockfall view islands.txt --dt 0.005")


if __name__ == "__main__":
    main()
