#include "tests/simulation/simulated_run.hpp"

#include <algorithm>

namespace collided::simulation {
using namespace engine;

using service::DefinitionSample;
using service::PoseSample;
using wire_contract::kPublisherLeaseNs;

namespace {

constexpr int kNames = 10;               // of objects; publishers want the same ones now and then
constexpr std::size_t kMostObjects = 4;  // a publisher
constexpr int kTroubledTicks = 150;
constexpr int kCalmTicks = 100;   // longer than a lease and a recovery
constexpr int kStillTicks = 300;  // longer than the longest way, two bookmarks, and what two clocks are apart

}  // namespace

SimulatedRun::SimulatedRun(std::uint64_t seed, std::FILE* to) : SeededChoices(seed), seed_(seed), to_(to) {
  payload_.put(seed);
  payload_.put(std::uint8_t{0});
  payload_.send(Kind::run, now_ns_, to_);
  for (std::size_t count = 2 + random_() % 3; count > 0; --count) {
    hosts_.push_back({.publisher = {next_id_++, 1, SimulatedClock(random_, now_ns_)}, .period = any_period()});
  }
}

void SimulatedRun::violation(const std::string& what) {
  ++violations_;
  std::fprintf(stderr, "violation: seed=%llu t=%.2f s epoch=%llu: %s\n", static_cast<unsigned long long>(seed_),
               1e-9 * static_cast<double>(now_ns_), static_cast<unsigned long long>(epoch_), what.c_str());
}

void SimulatedRun::run() {
  for (int i = 0; i < kTroubledTicks; ++i) tick(false);
  // What died stays dead, what sleeps wakes; the line is good from now on.
  for (Host& host : hosts_) host.sleeps_until_ns = std::min(host.sleeps_until_ns, now_ns_);
  payload_.send(Kind::calm, now_ns_, to_);
  for (int i = 0; i < kCalmTicks; ++i) tick(true);
  // Who was taken for lost says once more what it has, and poses nothing from then on.
  for (Host& host : hosts_) {
    if (host.is_dead || !chance(0.5)) continue;
    host.was_away = true;
    under_way_.push_back({now_ns_, Lost{host.publisher.id()}});
  }
  // What is still under way arrives.
  is_still_ = true;
  for (int i = 0; i < kStillTicks; ++i) tick(true);
  settle_truth();
}

void SimulatedRun::tick(bool is_calm) {
  now_ns_ += kTickNs;
  if (!server_ && now_ns_ >= server_back_ns_) {
    server_ =
        std::make_unique<SimulatedServer>(++epoch_, now_ns_, to_, [this](const std::string& what) { violation(what); });
    for (Host& host : hosts_) host.notices_at_ns = now_ns_ + up_to(150'000'000);
  }
  for (Host& host : hosts_) live(host, is_calm);
  if (!is_calm) trouble();
  deliver();
  if (server_) server_->tick(now_ns_);
}

void SimulatedRun::trouble() {
  if (server_ && chance(0.006)) {
    steps_ += server_->steps();
    server_.reset();
    server_back_ns_ = now_ns_ + 20'000'000 + up_to(200'000'000);
  }
  for (Host& host : hosts_) trouble(host);
}

void SimulatedRun::trouble(Host& host) {
  if (host.is_dead) {
    if (chance(0.02)) come_back(host);
  } else if (chance(0.004)) {
    crash(host);
  } else if (chance(0.01) && host.sleeps_until_ns <= now_ns_) {
    host.sleeps_until_ns = now_ns_ + up_to(3 * kPublisherLeaseNs);
    host.was_away = host.sleeps_until_ns - now_ns_ > kPublisherLeaseNs;
    if (host.was_away) under_way_.push_back({now_ns_ + kPublisherLeaseNs, Lost{host.publisher.id()}});
  } else if (chance(0.005)) {
    if (chance(0.5)) host.publisher.clock().jump(up_to(7'200'000'000'000) - 3'600'000'000'000);
    else host.publisher.clock().correct(up_to(kPublisherLeaseNs) - kPublisherLeaseNs / 2);
  }
}

void SimulatedRun::crash(Host& host) {
  host.is_dead = true;
  under_way_.push_back({now_ns_ + kPublisherLeaseNs, Lost{host.publisher.id()}});
  // Started again at once by its supervisor, while what it said last is still under way.
  if (chance(0.3)) come_back(host);
}

/// The same program again: mostly under a new number, as the library makes one, else a greater incarnation of the old.
void SimulatedRun::come_back(Host& host) {
  const bool is_known = chance(0.3);
  // What the old one had defined may be told once more, and late.
  std::vector<DefinitionSample> stale = host.publisher.define_all();
  SimulatedPublisher again(is_known ? host.publisher.id() : next_id_++, static_cast<std::uint64_t>(now_ns_),
                           SimulatedClock(random_, now_ns_));
  host = {.publisher = again,
          .period = any_period(),
          .definitions_at_ns = host.definitions_at_ns,
          .notices_at_ns = now_ns_};
  // The old one's end is news of its writers; those of the new one with the same number live.
  if (is_known) {
    for (DefinitionSample& sample : stale) under_way_.push_back({now_ns_ + up_to(100'000'000), std::move(sample)});
    std::erase_if(under_way_, [&](const Sent& sent) {
      const Lost* lost = std::get_if<Lost>(&sent.what);
      return lost != nullptr && lost->publisher == again.id();
    });
  }
}

void SimulatedRun::live(Host& host, bool is_calm) {
  if (host.is_dead || now_ns_ < host.sleeps_until_ns) return;
  const bool is_new_server = server_ && host.server_epoch != server_->epoch() && now_ns_ >= host.notices_at_ns;
  if (is_new_server || host.was_away) {
    host.was_away = false;
    if (server_) host.server_epoch = server_->epoch();
    for (DefinitionSample& sample : host.publisher.define_all()) send(host, std::move(sample));
    send(host.publisher.flush(now_ns_, false, false), true);  // empty: a sign of life
  }
  if (host.server_epoch == 0) return;
  if (is_still_) {
    // All rest: pairs of two publishers are known up to their last words.
    send(host.publisher.flush(now_ns_, false, false), true);
    return;
  }
  act(host, is_calm);
}

void SimulatedRun::act(Host& host, bool is_calm) {
  SimulatedPublisher& publisher = host.publisher;
  if (publisher.objects().size() < kMostObjects && chance(0.1)) add_object(host);
  if (!publisher.objects().empty() && chance(0.02)) {
    send(host, publisher.remove(std::next(publisher.objects().begin(),
                                          static_cast<std::ptrdiff_t>(random_() % publisher.objects().size()))
                                    ->first));
  }
  const bool teleported = chance(0.05);
  for (const auto& [number, object] : publisher.objects()) {
    if (chance(0.4)) publisher.move(number, teleported ? any_place() : Vec3(object.position + 0.1 * any_place()));
  }
  const bool is_due = now_ns_ / kTickNs % host.period == 0;
  if (is_due && (is_calm || chance(0.8))) send(publisher.flush(now_ns_, teleported, is_calm), is_calm);
}

void SimulatedRun::add_object(Host& host) {
  SimulatedPublisher::Object object;
  object.name = "object " + std::to_string(random_() % kNames);
  if (host.publisher.has_name(object.name)) return;
  object.position = any_place();
  object.radius_m = 0.3 + 0.4 * std::uniform_real_distribution<double>()(random_);
  object.policy = static_cast<LostPolicy>(random_() % 3);
  send(host, host.publisher.add(object));
}

/// Reliable and in order, some of them twice.
void SimulatedRun::send(Host& host, DefinitionSample sample) {
  host.definitions_at_ns = std::max(host.definitions_at_ns, now_ns_ + up_to(40'000'000));
  if (chance(0.1)) under_way_.push_back({host.definitions_at_ns, sample});
  under_way_.push_back({host.definitions_at_ns, std::move(sample)});
}

void SimulatedRun::send(PoseSample sample, bool is_calm) {
  if (!is_calm && chance(0.15)) return;
  if (chance(0.05)) under_way_.push_back({now_ns_ + up_to(60'000'000), sample});
  const std::int64_t motion_ns = chance(0.7) ? 0 : up_to(50'000'000);
  under_way_.push_back({now_ns_ + motion_ns, std::move(sample)});
}

void SimulatedRun::deliver() {
  // By time; what was sent first comes first among equals.
  std::stable_sort(under_way_.begin(), under_way_.end(),
                   [](const Sent& a, const Sent& b) { return a.time_ns < b.time_ns; });
  const auto later =
      std::find_if(under_way_.begin(), under_way_.end(), [&](const Sent& sent) { return sent.time_ns > now_ns_; });
  for (auto sent = under_way_.begin(); sent != later && server_; ++sent) {
    if (auto* definition = std::get_if<DefinitionSample>(&sent->what)) {
      server_->take(*definition, now_ns_);
    } else if (auto* poses = std::get_if<PoseSample>(&sent->what)) {
      server_->take(*poses, now_ns_);
    } else {
      server_->lost(std::get<Lost>(sent->what).publisher, now_ns_);
    }
  }
  under_way_.erase(under_way_.begin(), later);
}

/// Every living publisher's object is there, or another living one's of the same name; where it is, is where its
/// publisher put it. Of the dead, only what was to stay is left.
void SimulatedRun::settle_truth() {
  const SnapshotRing::Lease newest = server_->world().newest();
  const auto claims = [&](const Host& host, const std::string& name, const Vec3* at) {
    const auto& objects = host.publisher.objects();
    return !host.is_dead && std::any_of(objects.begin(), objects.end(), [&](const auto& entry) {
      return entry.second.name == name && (at == nullptr || entry.second.position == *at);
    });
  };
  for (const auto& info : newest->objects) {
    if (!info) continue;
    const auto is_claimed = [&](const Vec3* at) {
      return std::any_of(hosts_.begin(), hosts_.end(), [&](const Host& host) { return claims(host, info->name, at); });
    };
    const Vec3 at = newest->poses[slot_of(info->id)].position;
    if (is_claimed(nullptr)) {
      if (!is_claimed(&at)) violation("'" + info->name + "' is not where a publisher put it");
      if (newest->stale[slot_of(info->id)] != 0) violation("'" + info->name + "' of a living publisher is stale");
    } else if (info->lost_policy == LostPolicy::remove) {
      violation("'" + info->name + "' is a ghost");
    }
  }
  for (const Host& host : hosts_) {
    for (const auto& [number, object] : host.publisher.objects()) {
      if (!host.is_dead && !server_->world().find(object.name)) violation("'" + object.name + "' is missing");
    }
  }
  server_->compare_with_all_pairs();
  std::vector<std::uint8_t> names;
  const std::set<NamedPair> truth = server_->touching();
  for (const auto& [a, b] : truth) {
    for (const std::string* name : {&a, &b}) {
      names.insert(names.end(), name->begin(), name->end());
      names.push_back(0);
    }
  }
  payload_.put(names);
  payload_.send(Kind::truth, now_ns_, to_);
  steps_ += server_->steps();
}

}  // namespace collided::simulation
