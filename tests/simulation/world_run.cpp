// The world's side of the simulation: world_run FIRST_SEED COUNT [fleet] writes a record to its standard output.

#include <cstdio>
#include <cstdlib>
#include <string>

#include "tests/simulation/simulated_fleet.hpp"
#include "tests/simulation/simulated_run.hpp"

namespace collided::simulation {
namespace {

struct Totals {
  std::uint64_t steps = 0;
  std::uint64_t violations = 0;
  std::uint64_t takeovers = 0;
};

void run(std::uint64_t seed, bool is_fleet, Totals& totals) {
  if (is_fleet) {
    SimulatedFleet fleet(seed, stdout);
    fleet.run();
    totals.takeovers += fleet.takeovers();
    totals.steps += fleet.steps();
    totals.violations += fleet.violations();
    return;
  }
  SimulatedRun one(seed, stdout);
  one.run();
  totals.steps += one.steps();
  totals.violations += one.violations();
}

}  // namespace
}  // namespace collided::simulation

int main(int argc, char** argv) {
  using namespace collided::simulation;
  const bool is_fleet = argc == 4 && std::string(argv[3]) == "fleet";
  if (argc != 3 && !is_fleet) {
    std::fprintf(stderr, "usage: world_run FIRST_SEED COUNT [fleet]\n");
    return 2;
  }
  const std::uint64_t first = std::strtoull(argv[1], nullptr, 10);
  const std::uint64_t count = std::strtoull(argv[2], nullptr, 10);
  Totals totals;
  for (std::uint64_t seed = first; seed < first + count; ++seed) run(seed, is_fleet, totals);
  Payload payload;
  payload.put(count);
  payload.put(totals.steps);
  payload.put(totals.violations);
  payload.put(totals.takeovers);
  return payload.send(Kind::end, 0, stdout) && std::fflush(stdout) == 0 ? 0 : 1;
}
