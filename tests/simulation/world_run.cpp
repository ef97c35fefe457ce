// The world's side of the simulation: world_run FIRST_SEED COUNT writes a record to its standard output.

#include <cstdio>
#include <cstdlib>

#include "tests/simulation/simulated_run.hpp"

int main(int argc, char** argv) {
  using namespace collided::simulation;
  if (argc != 3) {
    std::fprintf(stderr, "usage: world_run FIRST_SEED COUNT\n");
    return 2;
  }
  const std::uint64_t first = std::strtoull(argv[1], nullptr, 10);
  const std::uint64_t count = std::strtoull(argv[2], nullptr, 10);
  std::uint64_t steps = 0;
  std::uint64_t violations = 0;
  for (std::uint64_t seed = first; seed < first + count; ++seed) {
    SimulatedRun run(seed, stdout);
    run.run();
    steps += run.steps();
    violations += run.violations();
  }
  Payload totals;
  totals.put(count);
  totals.put(steps);
  totals.put(violations);
  return totals.send(Kind::end, 0, stdout) && std::fflush(stdout) == 0 ? 0 : 1;
}
