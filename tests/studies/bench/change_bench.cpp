// Small changes of a large world, one thread: an object joins or leaves, name patterns are used in turn, one box of a pile
// moves. Each with what must follow the change before the next question has its answer.
// usage: change_bench [--quick] [--csv FILE] [--only NAME] [--no-header]

#include <functional>

#include "tests/oracle/seed.hpp"
#include "tests/studies/bench/changing_world.hpp"
#include "tests/studies/bench/rows.hpp"

namespace collided::bench {
namespace {

/// One row: `change` many times, nanoseconds each.
void run(const Options& options, const Work& work, const std::function<double()>& change) {
  if (!options.wants(work.scene, work.name)) return;
  const int times = options.quick ? 50 : 500;
  std::vector<Method> methods{{.name = "collided", .own_ns = [&] {
                                 double seconds = 0;
                                 for (int i = 0; i < times; ++i) seconds += change();
                                 return 1e9 * seconds / times;
                               }}};
  measure(options, work, methods);
}

void run_joins(const Options& options, std::size_t count, const std::mt19937_64& random) {
  JoiningCrowd crowd(count, random);
  const auto row = [&](const char* name, double (JoiningCrowd::*change)()) {
    run(options, {.scene = "balls", .size = count, .name = name}, [&] { return (crowd.*change)(); });
  };
  row("two patterns in turn", &JoiningCrowd::ask_in_turn);
  row("pattern after a join", &JoiningCrowd::ask_after_join);
  row("join, step, ray", &JoiningCrowd::join);
  row("leave, step, ray", &JoiningCrowd::leave);
}

}  // namespace
}  // namespace collided::bench

int main(int argc, char** argv) {
  using namespace collided;
  const bench::Options options = bench::read_options(argc, argv);
  const std::mt19937_64 random = oracle::seeded(20261134);
  for (const std::size_t count : {10'000, 100'000}) {
    if (!options.quick || count == 10'000) bench::run_joins(options, count, random);
  }
  for (const std::size_t count : {200, 1'000, 3'000}) {
    if ((options.quick && count > 200) || !options.wants("pile of boxes", "one moves")) continue;
    bench::BoxPile pile(count, random);
    bench::run(options, {.scene = "pile of boxes", .size = count, .name = "one moves"},
               [&] { return pile.move_one(); });
  }
  return 0;
}
