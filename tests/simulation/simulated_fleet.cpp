#include "tests/simulation/simulated_fleet.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <utility>

namespace collided::simulation {
using namespace engine;

using service::DefinitionSample;
using service::PoseSample;

namespace {

constexpr int kTroubledTicks = 1'200;
constexpr int kCalmTicks = 100;
constexpr int kStillTicks = 300;
constexpr std::int64_t kTakeOverNs = 200'000'000;
constexpr std::int64_t kLongestDelayNs = 50'000'000;
constexpr std::size_t kMostObjects = 4;  // a publisher
constexpr double kApart_m = 100;
constexpr std::int64_t kApartNs = 1'000'000'000;

}  // namespace

SimulatedFleet::SimulatedFleet(std::uint64_t seed, std::FILE* to) : SeededChoices(seed), seed_(seed), to_(to) {
  payload_.put(seed);
  payload_.put(std::uint8_t{1});
  payload_.send(Kind::run, now_ns_, to_);
  for (std::uint64_t id = 1; id <= 2 + seed % 3; ++id) {
    hosts_.push_back(
        {.publisher = {id, 1, SimulatedClock::near(random_, now_ns_)}, .period = chance(0.5) ? 1 : any_period()});
  }
  expected_ = make_member(1, Voice::is_expected);
  primary_ = make_member(++epoch_, Voice::speaks);
  heard_ns_ = now_ns_;
  standby_starts_ns_ = now_ns_ + up_to(500'000'000);
}

/// Of publishers as unlike as a camera and a wheel's encoder: 2 to 100 ticks, of each order of magnitude as many.
std::int64_t SimulatedFleet::any_period() {
  return std::llround(std::exp(std::uniform_real_distribution<>(std::log(2.0), std::log(100.0))(random_)));
}

void SimulatedFleet::violation(const std::string& what) {
  ++violations_;
  std::fprintf(stderr, "violation: fleet seed=%llu t=%.2f s epoch=%llu: %s\n", static_cast<unsigned long long>(seed_),
               1e-9 * static_cast<double>(now_ns_), static_cast<unsigned long long>(epoch_), what.c_str());
}

std::unique_ptr<SimulatedFleet::Member> SimulatedFleet::make_member(std::uint64_t epoch, Voice voice) {
  auto member = std::make_unique<Member>();
  member->server = std::make_unique<SimulatedServer>(
      epoch, now_ns_, to_, [this](const std::string& what) { violation(what); }, voice, true);
  return member;
}

template <class Work>
void SimulatedFleet::for_each_member(Work&& work) {
  for (const std::unique_ptr<Member>* member : {&expected_, &primary_, &standby_, &resumed_})
    if (*member) work(**member);
}

void SimulatedFleet::run() {
  for (int i = 0; i < kTroubledTicks; ++i) tick(false);
  payload_.send(Kind::calm, now_ns_, to_);
  for (int i = 0; i < kCalmTicks; ++i) tick(true);
  is_still_ = true;
  for (Host& host : hosts_) flush(host, true);
  for (int i = 0; i < kStillTicks; ++i) tick(true);
  settle_truth();
}

void SimulatedFleet::tick(bool is_calm) {
  now_ns_ += kTickNs;
  for (std::size_t i = 0; i < hosts_.size(); ++i) act(hosts_[i], i);
  if (!is_calm) trouble();
  for_each_member([&](Member& member) {
    if (now_ns_ < member.stands_still_until_ns) return;
    deliver(member);
    member.server->tick(now_ns_);
  });
  // Its last words are said; now it learns that another one has its place.
  if (resumed_ && now_ns_ >= resumed_->stands_still_until_ns + 2 * kTickNs) {
    steps_ += resumed_->server->steps();
    resumed_.reset();
  }
  compare_worlds();
  replace_primary();
}

void SimulatedFleet::act(Host& host, std::size_t number) {
  SimulatedPublisher& publisher = host.publisher;
  if (host.says_again_ns != 0 && now_ns_ >= host.says_again_ns) define_all(host);
  if (is_still_) return flush(host, false);
  if (publisher.objects().size() < kMostObjects && chance(0.05)) {
    SimulatedPublisher::Object object;
    object.name = "object " + std::to_string(publisher.objects().size()) + " of " + std::to_string(number);
    // It is there from when each server hears of it: where nothing comes by, and until its publisher's clock, which may be
    // behind, has passed that too. So no event depends on it.
    const double angle = 0.3 * static_cast<double>(kMostObjects * number + publisher.objects().size());
    object.position = Vec3(kApart_m * std::cos(angle), kApart_m * std::sin(angle), 0);
    object.radius_m = 0.3 + 0.4 * std::uniform_real_distribution<double>()(random_);
    const DefinitionSample sample = publisher.add(object);
    host.added_ns[sample.object_number] = now_ns_;
    send(sample);
  }
  for (const auto& [key, object] : publisher.objects()) {
    if (!chance(0.4)) continue;
    const bool is_apart = object.position.norm() > kApart_m / 2;
    const std::int64_t stays_ns = kApartNs + 4 * host.period * kTickNs;
    if (is_apart && (now_ns_ < host.added_ns[key] + stays_ns || !chance(0.1))) continue;
    publisher.move(key, is_apart ? any_place() : Vec3(object.position + 0.1 * any_place()));
  }
  // Now and then it has nothing to say, or no time.
  const bool is_due = now_ns_ / kTickNs % host.period == 0;
  if (is_due && chance(0.85)) flush(host, false);
}

void SimulatedFleet::flush(Host& host, bool everything) {
  PoseSample sample = host.publisher.flush(now_ns_, false, everything);
  if (now_ns_ < host.all_said_until_ns) sample.flags |= wire_contract::kPosesAllSaid;
  send(sample);
}

void SimulatedFleet::define_all(Host& host) {
  host.says_again_ns = 0;
  host.all_said_until_ns = now_ns_ + 2'000'000'000;
  for (const DefinitionSample& sample : host.publisher.define_all()) send(sample);
  PoseSample sign_of_life = host.publisher.word();
  sign_of_life.flags |= wire_contract::kPosesAllSaid;
  send(sign_of_life);
}

/// What is sent comes to every server that is there, in the order of its topic, each copy after a time of its own.
void SimulatedFleet::send(const DefinitionSample& sample) {
  for_each_member([&](Member& member) {
    std::int64_t& at_ns = member.lines[sample.publisher].definitions_ns;
    at_ns = std::max(at_ns, now_ns_ + up_to(kLongestDelayNs));
    member.under_way.push_back({at_ns, sample});
  });
}

void SimulatedFleet::send(const PoseSample& sample) {
  for_each_member([&](Member& member) {
    std::int64_t& at_ns = member.lines[sample.publisher].poses_ns;
    at_ns = std::max(at_ns, now_ns_ + (chance(0.7) ? 0 : up_to(kLongestDelayNs)));
    member.under_way.push_back({at_ns, sample});
  });
}

void SimulatedFleet::deliver(Member& member) {
  std::stable_sort(member.under_way.begin(), member.under_way.end(),
                   [](const Sent& a, const Sent& b) { return a.time_ns < b.time_ns; });
  const auto later = std::find_if(member.under_way.begin(), member.under_way.end(),
                                  [&](const Sent& sent) { return sent.time_ns > now_ns_; });
  for (auto sent = member.under_way.begin(); sent != later; ++sent)
    std::visit([&](auto& sample) { member.server->take(sample, now_ns_); }, sent->what);
  member.under_way.erase(member.under_way.begin(), later);
}

/// The standby compares its world with the primary's, and has publishers say all again where they differ, ever more seldom.
void SimulatedFleet::compare_worlds() {
  if (!standby_ || !primary_) return;
  if (now_ns_ >= primary_->stands_still_until_ns) {
    heard_ns_ = now_ns_;
    standby_->comparison.hear(primary_->server->digests().newest());
  }
  const service::DigestMaker& own = standby_->server->digests();
  if (own.newest().time_ns != standby_->noted_digest_ns) {
    standby_->noted_digest_ns = own.newest().time_ns;
    standby_->comparison.note_own(own.newest(), own.state());
  }
  const std::uint64_t differing = standby_->comparison.differing();
  const bool is_same = standby_->comparison.compared() > 0 && differing == 0;
  if (is_same && !standby_->is_same) standby_->same_from_ns = standby_->comparison.compared_to_ns();
  standby_->is_same = is_same;
  if (std::exchange(standby_->differed, differing) != differing && std::has_single_bit(differing))
    ask_publishers_again();
}

void SimulatedFleet::ask_publishers_again() {
  for (Host& host : hosts_) host.says_again_ns = now_ns_ + up_to(100'000'000);
}

void SimulatedFleet::trouble() {
  if (!standby_ || !primary_ || primary_->stands_still_until_ns > now_ns_) return;
  const bool is_ready = standby_->is_same;
  if (chance(0.002)) {
    standby_.reset();
    standby_starts_ns_ = now_ns_ + up_to(300'000'000);
  } else if (is_ready && chance(0.01)) {
    steps_ += primary_->server->steps();
    primary_.reset();
  } else if (is_ready && chance(0.01)) {
    primary_->stands_still_until_ns = now_ns_ + up_to(1'000'000'000);
  }
}

void SimulatedFleet::replace_primary() {
  if (!standby_ && primary_ && now_ns_ >= standby_starts_ns_) {
    standby_ = make_member(++epoch_, Voice::is_silent);
    ask_publishers_again();
  }
  const bool is_heard = primary_ && now_ns_ >= primary_->stands_still_until_ns;
  if (standby_ && !is_heard && now_ns_ - heard_ns_ > kTakeOverNs) take_over();
}

void SimulatedFleet::take_over() {
  ++takeovers_;
  if (primary_) resumed_ = std::move(primary_);
  primary_ = std::move(standby_);
  primary_->server->speak(now_ns_, {.heard_ns = heard_ns_, .same_from_ns = primary_->same_from_ns});
  heard_ns_ = now_ns_;
  standby_starts_ns_ = now_ns_ + up_to(300'000'000);
}

/// The one that speaks holds what the one that never failed holds, and every publisher's objects where it put them.
void SimulatedFleet::settle_truth() {
  SimulatedServer& server = *primary_->server;
  const SnapshotRing::Lease newest = server.world().newest();
  for (const Host& host : hosts_) {
    for (const auto& [number, object] : host.publisher.objects()) {
      const auto id = server.world().find(object.name);
      if (!id) violation("'" + object.name + "' is missing");
      else if (newest->poses[slot_of(*id)].position != object.position)
        violation("'" + object.name + "' is not where its publisher put it");
    }
  }
  server.compare_with_all_pairs();
  if (server.touching() != expected_->server->touching())
    violation("it holds other contacts than the one that never failed");
  std::vector<std::uint8_t> names;
  for (const auto& [a, b] : server.touching()) {
    for (const std::string* name : {&a, &b}) {
      names.insert(names.end(), name->begin(), name->end());
      names.push_back(0);
    }
  }
  payload_.put(names);
  payload_.send(Kind::truth, now_ns_, to_);
  for_each_member([&](Member& member) { steps_ += member.server->steps(); });
}

}  // namespace collided::simulation
