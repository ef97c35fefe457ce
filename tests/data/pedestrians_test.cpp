#include <cstdio>
#include <map>
#include <set>

#include "server/intake/scene.hpp"
#include "server/world/query/query.hpp"
#include "tests/data/recorded.hpp"

namespace collided::recorded {
using namespace engine;
namespace {

class RecordedPedestrians : public RecordedReality {
 protected:
  /// For every position of a run, the barrier that holds it (empty: none): a ray straight up meets its lid.
  std::vector<std::string> barriers(const Rows& persons) {
    World world{WorldOptions{}};
    LoadReport report;
    Scene walls = load_scene((data_ / "bottleneck_wuppertal/walls.obj").string(), {}, report);
    const auto indexed = World::index_scene(walls, {.threads = 1, .progress = {}, .cancelled = {}});
    EXPECT_TRUE(std::holds_alternative<std::uint32_t>(world.add_scene(indexed)));
    world.step(1, 1, {.contacts = false});
    std::vector<double> numbers;
    for (std::size_t row = 0; row < persons.size(); ++row) {
      const Vec3 head = persons.point(row);
      numbers.insert(numbers.end(), {head[0], head[1], head[2], 0, 0, 1, 10});
    }
    Questions questions;
    questions.mode = HitMode::closest;
    questions.numbers = numbers;
    Answers answers;
    QueryScratch scratch;
    const SnapshotRing::Lease lease = world.newest();
    answer(*lease, questions, answers, scratch);
    std::vector<std::string> inside;
    std::size_t hit = 0;
    for (std::size_t i = 0; i < answers.answers.size(); ++i) {
      EXPECT_NE(answers.answers[i], Verdict::undecided);
      const bool is_hit = answers.hit_counts[i] > 0;
      inside.push_back(is_hit ? world.info(answers.hits[hit].object)->name : "");
      hit += answers.hit_counts[i];
    }
    return inside;
  }
};

/// "walls/barrier_left" -> "barrier_left"
std::string without_scene(const std::string& name) { return name.substr(name.rfind('/') + 1); }

// A real bottleneck between two barriers, heads at 25 Hz: in one run nobody's head is within a barrier.
TEST_F(RecordedPedestrians, NobodyOfTheOneRunLeansOverABarrier) {
  const Rows persons(data_ / "bottleneck_wuppertal/persons_040.csv.gz");
  std::size_t inside = 0;
  for (const std::string& barrier : barriers(persons)) inside += barrier.empty() ? 0 : 1;
  std::printf("%zu positions, %zu inside\n", persons.size(), inside);
  EXPECT_EQ(persons.size(), 63'110u);
  EXPECT_EQ(inside, 0u);
}

// In the other run 22 people lean over, 1,409 times in 42 intervals of frames: the very positions that GEOS names.
TEST_F(RecordedPedestrians, ThoseWhoLeanOverAreTheOnesThatGeosNames) {
  const auto folder = data_ / "bottleneck_wuppertal";
  const Rows persons(folder / "persons_030.csv.gz"), expected(folder / "expected_inside.csv"),
      events(folder / "expected_events.csv");
  using Place = std::pair<std::string, int>;  // barrier and person
  std::map<Place, std::set<int>> ours, theirs;
  const std::vector<std::string> barrier = barriers(persons);
  std::size_t inside = 0;
  for (std::size_t row = 0; row < persons.size(); ++row) {
    if (barrier[row].empty()) continue;
    ++inside;
    ours[{without_scene(barrier[row]), persons.integer(row, "id")}].insert(persons.integer(row, "frame"));
  }
  for (std::size_t row = 0; row < expected.size(); ++row) {
    theirs[{expected.text(row, "obstacle"), expected.integer(row, "id")}].insert(expected.integer(row, "frame"));
  }
  std::set<std::tuple<std::string, int, int, int>> intervals, listed;
  for (const auto& [place, frames] : ours) {
    for (auto first = frames.begin(); first != frames.end();) {
      auto last = first;
      while (std::next(last) != frames.end() && *std::next(last) == *last + 1) ++last;
      intervals.insert({place.first, place.second, *first, *last});
      first = std::next(last);
    }
  }
  for (std::size_t row = 0; row < events.size(); ++row) {
    listed.insert({events.text(row, "obstacle"), events.integer(row, "id"), events.integer(row, "first_frame"),
                   events.integer(row, "last_frame")});
  }
  std::printf("%zu positions, %zu inside, %zu intervals\n", persons.size(), inside, intervals.size());
  EXPECT_EQ(persons.size(), 61'871u);
  EXPECT_EQ(inside, 1409u);
  EXPECT_EQ(intervals.size(), 42u);
  EXPECT_TRUE(ours == theirs);
  EXPECT_TRUE(intervals == listed);
}

}  // namespace
}  // namespace collided::recorded
