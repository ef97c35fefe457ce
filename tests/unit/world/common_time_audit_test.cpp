// Random sequences of all that publishers may do, held after each step against what their words say: every pair is decided
// up to the instant to which both are known, neither less nor twice.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "idl/topics.hpp"
#include "server/world/world.hpp"
#include "tests/oracle/seed.hpp"

namespace collided::engine {
namespace {

constexpr std::int64_t kAuditStart = 1'000'000'000'000;
constexpr std::int64_t kAuditMs = 1'000'000;
constexpr double kRadius_m = 0.5;
constexpr std::int64_t kMemoryNs = 10'000'000'000;
constexpr std::uint64_t kPublishers = 4;

/// From one place to another; from_ns == to_ns is a jump.
struct Way {
  std::int64_t from_ns = 0, to_ns = 0;
  Vec3 from, to;
};

/// A ball as its publisher's words say: all of its life, nothing of candidates.
struct Ball {
  std::uint64_t publisher = 0;
  std::int64_t birth_ns = 0;  // 0: at the next step
  std::int64_t posed_ns = 0;
  Vec3 start, end;
  std::vector<Way> motions;

  Vec3 at(std::int64_t time_ns, bool before_jump = false) const {
    Vec3 place = start;
    for (const Way& displacement : motions) {
      if (time_ns < displacement.from_ns ||
          (before_jump && displacement.from_ns == displacement.to_ns && time_ns == displacement.to_ns))
        break;
      if (time_ns >= displacement.to_ns) {
        place = displacement.to;
      } else {
        const double share = static_cast<double>(time_ns - displacement.from_ns) /
                             static_cast<double>(displacement.to_ns - displacement.from_ns);
        place = displacement.from + share * (displacement.to - displacement.from);
      }
    }
    return place;
  }
};

/// What a publisher has said, by TIME's rules: an instant that is past counts as the next nanosecond.
struct Voice {
  bool is_timed = false;
  std::int64_t gap_ns = wire_contract::kDefaultGapNs;
  std::int64_t known_ns = 0, before_ns = 0, settled_ns = 0;
};

using Pair = std::pair<ObjectId, ObjectId>;

struct PairState {
  std::int64_t decided_ns = std::numeric_limits<std::int64_t>::min();
  bool is_held = false;
  bool is_doubtful = false;  // too near to touching for doubles
};

class Audit {
 public:
  explicit Audit(std::mt19937_64& random) : random_(random) {
    for (std::uint64_t publisher = 1; publisher <= kPublishers; ++publisher) {
      lag_ns_[publisher] = up_to(200 * kAuditMs) - 50 * kAuditMs;
      if (chance(0.5))
        world_.set_gap(publisher, gaps_ns_[publisher] = 1 + up_to(chance(0.5) ? 50 * kAuditMs : 8'000 * kAuditMs));
    }
    step();
  }

  void act() {
    const std::uint64_t publisher = 1 + random_() % kPublishers;
    const double dice = std::uniform_real_distribution<double>(0, 1)(random_);
    if (dice < 0.06) define(publisher);
    else if (dice < 0.08) remove(any_of(publisher));
    else if (dice < 0.11) redefine(publisher);
    else if (dice < 0.13) lose(publisher);
    else if (dice < 0.14)
      lag_ns_[publisher] = chance(0.2) ? 12'000 * kAuditMs : up_to(3'000 * kAuditMs) - 20 * kAuditMs;
    else if (dice < 0.145) lag_ns_[publisher] = 0;
    else if (dice < 0.16) now_ns_ += up_to(12'000 * kAuditMs);
    else if (dice < 0.24) live(publisher);
    else if (dice < 0.56) flush(publisher);
    else step();
  }

  int begins = 0, checked = 0, passed_by_floor = 0, waited = 0;
  std::string fault;

 private:
  std::int64_t up_to(std::int64_t most) { return std::uniform_int_distribution<std::int64_t>(0, most)(random_); }
  bool chance(double share) { return std::bernoulli_distribution(share)(random_); }
  Vec3 any_place() {
    std::uniform_real_distribution<double> in(-1.5, 1.5);
    const double x = in(random_), y = in(random_);
    return {x, y, in(random_)};
  }

  std::optional<ObjectId> any_of(std::uint64_t publisher) {
    std::vector<ObjectId> own;
    for (const auto& [id, ball] : balls_) {
      if (ball.publisher == publisher) own.push_back(id);
    }
    if (own.empty()) return std::nullopt;
    return own[random_() % own.size()];
  }

  void define(std::uint64_t publisher) {
    if (balls_.size() < 12) enter(publisher, any_place(), "ball" + std::to_string(count_++));
  }

  void enter(std::uint64_t publisher, const Vec3& at, const std::string& name) {
    ObjectDefinition definition;
    definition.name = name;
    definition.shape.primitives.emplace_back(Sphere{Vec3::Zero(), kRadius_m});
    definition.publisher = publisher;
    definition.pose.position = at;
    const ObjectId id = std::get<ObjectId>(world_.define(definition));
    Ball ball{.publisher = publisher, .start = at, .end = at, .motions = {}};
    Voice& voice = voices_[publisher];
    if (gaps_ns_.contains(publisher)) voice.gap_ns = gaps_ns_[publisher];
    if (!any_of_silently(publisher)) {
      voice.known_ns = std::max(voice.known_ns, floor_ns_);
      voice.settled_ns = std::max(voice.settled_ns, floor_ns_);
    }
    if (voice.is_timed) ball.birth_ns = ball.posed_ns = voice.known_ns;
    balls_.emplace(id, std::move(ball));
  }

  void remove(std::optional<ObjectId> id) {
    if (!id) return;
    const std::uint64_t publisher = balls_.at(*id).publisher;
    EXPECT_TRUE(world_.remove(*id, EndReason::removed));
    balls_.erase(*id);
    std::erase_if(pairs_, [&](const auto& entry) { return entry.first.first == *id || entry.first.second == *id; });
    if (!any_of(publisher) && !voices_[publisher].is_timed) voices_.erase(publisher);
  }

  /// Its publisher lost sight of the server and defines it once more, mostly where it was.
  void redefine(std::uint64_t publisher) {
    const std::optional<ObjectId> id = any_of(publisher);
    if (!id) return;
    const std::string name = world_.info(*id)->name;
    const Vec3 at = chance(0.7) ? balls_.at(*id).end : any_place();
    remove(id);
    enter(publisher, at, name);
  }

  void lose(std::uint64_t publisher) {
    if (!voices_.contains(publisher)) return;
    world_.lose(publisher);
    voices_[publisher].is_timed = false;
    const bool comes_back_as_it_was = chance(0.5);
    std::vector<std::pair<std::string, Vec3>> gone;
    while (const std::optional<ObjectId> id = chance(0.5) || !gone.empty() ? any_of(publisher) : std::nullopt) {
      gone.emplace_back(world_.info(*id)->name, balls_.at(*id).end);
      remove(id);
    }
    if (!any_of(publisher)) voices_.erase(publisher);
    if (chance(0.5)) step();
    if (!comes_back_as_it_was) return;
    for (const auto& [name, at] : gone) {
      enter(publisher, at, name);
      if (chance(0.3)) step();
    }
  }

  /// Some of its objects, or none, at its own time.
  void flush(std::uint64_t publisher) {
    std::vector<ObjectId> posed;
    const double share = chance(0.3) ? 1 : chance(0.4) ? 0 : 0.5;
    for (const auto& [id, ball] : balls_) {
      if (ball.publisher == publisher && chance(share)) posed.push_back(id);
    }
    if (std::any_of(posed.begin(), posed.end(),
                    [&](ObjectId id) { return world_.has_moved(id) && balls_.at(id).birth_ns != 0; }))
      step();
    const bool is_late = chance(0.05);
    std::int64_t time_ns = now_ns_ - lag_ns_[publisher] - (is_late ? up_to(500 * kAuditMs) : 0);
    if (voices_.contains(publisher))
      time_ns = std::max(time_ns, voices_[publisher].known_ns - (is_late ? 100 * kAuditMs : -1));
    for (const ObjectId id : posed) {
      if (posed_.insert(id).second) pose(id, time_ns, chance(0.1));
    }
    world_.advance(publisher, time_ns);
    if (!voices_.contains(publisher)) return;
    Voice& voice = voices_[publisher];
    time_ns = admitted(voice, time_ns);
    if (time_ns > voice.known_ns) {
      voice.before_ns = voice.known_ns;
      voice.known_ns = time_ns;
    }
    begin_all(publisher, voice);
  }

  /// A sign of life at its own time: its objects are known up to one gap before.
  void live(std::uint64_t publisher) {
    const std::int64_t time_ns = now_ns_ - lag_ns_[publisher];
    world_.advance(publisher, time_ns, true);
    if (!voices_.contains(publisher)) return;
    Voice& voice = voices_[publisher];
    if (time_ns - voice.gap_ns > voice.known_ns) {
      voice.before_ns = voice.known_ns;
      voice.known_ns = time_ns - voice.gap_ns;
    }
    begin_all(publisher, voice);
  }

  void begin_all(std::uint64_t publisher, Voice& voice) {
    voice.is_timed = true;
    for (auto& [id, ball] : balls_) {
      if (ball.publisher == publisher && ball.birth_ns == 0) begin(ball, voice.known_ns);
    }
  }

  static std::int64_t admitted(const Voice& voice, std::int64_t time_ns) {
    return time_ns <= voice.settled_ns ? voice.settled_ns + 1 : time_ns;
  }

  /// Poses from before its beginning hold from then on.
  void begin(Ball& ball, std::int64_t time_ns) {
    ball.birth_ns = time_ns;
    ball.posed_ns = std::max(ball.posed_ns, ball.birth_ns);
    for (Way& displacement : ball.motions) {
      displacement.from_ns = std::max(displacement.from_ns, ball.birth_ns);
      displacement.to_ns = std::max(displacement.to_ns, ball.birth_ns);
    }
  }

  void pose(ObjectId id, std::int64_t time_ns, bool teleport) {
    Ball& ball = balls_.at(id);
    const Voice& voice = voices_[ball.publisher];
    const Vec3 to = chance(0.5) ? any_place() : Vec3(ball.end + 0.2 * any_place());
    EXPECT_TRUE(world_.move(id, {.position = to}, time_ns, teleport));
    time_ns = admitted(voice, time_ns);
    std::int64_t since_ns = std::max({ball.posed_ns, ball.birth_ns, voice.settled_ns});
    if (voice.is_timed && ball.birth_ns != 0)
      since_ns =
          std::max({since_ns, time_ns > voice.known_ns ? voice.known_ns : voice.before_ns, time_ns - voice.gap_ns});
    time_ns = std::max(time_ns, ball.posed_ns);
    if (teleport || ball.birth_ns == 0) since_ns = time_ns;
    ball.motions.push_back({std::min(since_ns, time_ns), time_ns, ball.end, to});
    ball.end = to;
    ball.posed_ns = time_ns;
  }

  void step() {
    now_ns_ += 1 + up_to(30 * kAuditMs);
    ASSERT_TRUE(world_.step(now_ns_, 1, {}));
    posed_.clear();
    for (auto& [publisher, voice] : voices_) {
      if (!voice.is_timed) voice.known_ns = std::max(voice.known_ns, now_ns_);
    }
    for (auto& [id, ball] : balls_) {
      if (ball.birth_ns == 0) begin(ball, voices_[ball.publisher].known_ns);
    }
    std::map<Pair, int> told;
    for (const Event& event : world_.events()) {
      if (event.kind == EventKind::began) ++told[{event.of.a, event.of.b}];
    }
    for (auto a = balls_.begin(); a != balls_.end(); ++a) {
      for (auto b = std::next(a); b != balls_.end(); ++b) judge({a->first, b->first}, a->second, b->second, told);
    }
    settle();
  }

  void settle() {
    std::int64_t newest_ns = 0, oldest_ns = std::numeric_limits<std::int64_t>::max();
    for (auto& [publisher, voice] : voices_) {
      voice.settled_ns = voice.known_ns;
      if (!any_of_silently(publisher)) continue;
      newest_ns = std::max(newest_ns, voice.settled_ns);
      oldest_ns = std::min(oldest_ns, voice.settled_ns);
    }
    if (newest_ns > 0) floor_ns_ = std::max({floor_ns_, oldest_ns, newest_ns - kMemoryNs});
  }

  bool any_of_silently(std::uint64_t publisher) const {
    return std::any_of(balls_.begin(), balls_.end(),
                       [&](const auto& entry) { return entry.second.publisher == publisher; });
  }

  void judge(const Pair& pair, const Ball& a, const Ball& b, const std::map<Pair, int>& told) {
    PairState& state = pairs_[pair];
    const std::int64_t to_ns = std::min(voices_[a.publisher].known_ns, voices_[b.publisher].known_ns);
    const std::int64_t begin_ns = std::max({a.birth_ns, b.birth_ns, a.publisher == b.publisher ? 0 : floor_ns_});
    const auto said = told.find(pair);
    const int told_begins = said == told.end() ? 0 : said->second;
    int expected = 0;
    if (to_ns >= begin_ns || state.decided_ns >= begin_ns) {
      const bool begins_here = begin_ns > state.decided_ns;
      passed_by_floor += begins_here && state.decided_ns > std::max(a.birth_ns, b.birth_ns) ? 1 : 0;
      if (begins_here) instant(a, b, begin_ns, state, expected);
      if (to_ns > std::max(begin_ns, state.decided_ns))
        go(a, b, std::max(begin_ns, state.decided_ns), to_ns, state, expected);
      state.decided_ns = std::max(state.decided_ns, to_ns);
    } else {
      ++waited;
    }
    const bool holds = std::any_of(world_.contacts().begin(), world_.contacts().end(),
                                   [&](const OpenContact& open) { return Pair(open.a, open.b) == pair; });
    if (state.is_doubtful) {
      state.is_held = holds;
      return;
    }
    ++checked;
    begins += expected;
    if (holds == state.is_held && told_begins == expected) return;
    fault = world_.info(pair.first)->name + " of " + std::to_string(a.publisher) + " and " +
            world_.info(pair.second)->name + " of " + std::to_string(b.publisher) + (holds ? " are" : " are not") +
            " in contact, begun " + std::to_string(told_begins) + " times, expected " +
            (state.is_held ? "contact, " : "none, ") + std::to_string(expected) + "; known to " +
            std::to_string(to_ns - kAuditStart) + ", both there from " + std::to_string(begin_ns - kAuditStart) +
            ", floor " + std::to_string(floor_ns_ - kAuditStart) + ", now " + std::to_string(now_ns_ - kAuditStart);
  }

  void instant(const Ball& a, const Ball& b, std::int64_t time_ns, PairState& state, int& expected) {
    const double gap_m = (a.at(time_ns) - b.at(time_ns)).norm() - 2 * kRadius_m;
    state.is_doubtful = state.is_doubtful || std::abs(gap_m) < 1e-9;
    expected += gap_m <= 0 && !state.is_held ? 1 : 0;
    state.is_held = gap_m <= 0;
  }

  void go(const Ball& a, const Ball& b, std::int64_t from_ns, std::int64_t to_ns, PairState& state, int& expected) {
    std::set<std::int64_t> times{to_ns};
    for (const Ball* ball : {&a, &b}) {
      for (const Way& displacement : ball->motions) {
        for (const std::int64_t time : {displacement.from_ns, displacement.to_ns}) {
          if (time > from_ns && time < to_ns) times.insert(time);
        }
      }
    }
    for (const std::int64_t time : times) {
      piece(a.at(from_ns) - b.at(from_ns), a.at(time, true) - b.at(time, true), state, expected);
      instant(a, b, time, state, expected);
      from_ns = time;
    }
  }

  /// The distance of two straight ways has one minimum: they meet at most once.
  static void piece(const Vec3& from, const Vec3& to, PairState& state, int& expected) {
    const Vec3 displacement = to - from;
    const double share =
        displacement.squaredNorm() > 0 ? std::clamp(-from.dot(displacement) / displacement.squaredNorm(), 0.0, 1.0) : 0;
    const double gap_m = (from + share * displacement).norm() - 2 * kRadius_m;
    state.is_doubtful = state.is_doubtful || std::abs(gap_m) < 1e-9;
    expected += gap_m <= 0 && !state.is_held ? 1 : 0;
    state.is_held = to.norm() <= 2 * kRadius_m;
  }

  std::mt19937_64& random_;
  World world_{WorldOptions{}};
  std::int64_t now_ns_ = kAuditStart;
  std::int64_t floor_ns_ = 0;
  std::map<std::uint64_t, Voice> voices_;
  std::map<std::uint64_t, std::int64_t> lag_ns_;
  std::map<std::uint64_t, std::int64_t> gaps_ns_;  // those that differ from the default
  std::map<ObjectId, Ball> balls_;
  std::set<ObjectId> posed_;  // since the last step
  std::map<Pair, PairState> pairs_;
  int count_ = 0;
};

// Define, pose, leave out, jump, lose, come back, define anew under the same name, remove, fall silent for longer than the
// memory, be late: whoever waits for whom, no pair is forgotten.
TEST(WorldCommonTimeAudit, EveryPairIsDecidedOnceUpToWhereBothAreKnown) {
  std::mt19937_64 random = oracle::seeded(1810);
  int begins = 0, checked = 0, waited = 0, passed = 0;
  for (int world = 0; world < 2'000; ++world) {
    const std::uint64_t seed = random();
    std::mt19937_64 own(seed);
    Audit audit(own);
    for (int i = 0; i < 300; ++i) {
      audit.act();
      ASSERT_EQ(audit.fault, "") << "world " << world << " after " << i << " acts";
    }
    begins += audit.begins;
    checked += audit.checked;
    waited += audit.waited;
    passed += audit.passed_by_floor;
  }
  EXPECT_GT(begins, 50'000);
  EXPECT_GT(waited, 10'000) << "pairs must wait to be worth it";
  EXPECT_GT(passed, 20) << "the memory must end before what somebody said";
  EXPECT_GT(checked, 100'000);
}

}  // namespace
}  // namespace collided::engine
