#include "server/fleet/authority/leadership.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <utility>

namespace collided::engine::service {
namespace {

/// With leading zeros, so that bytes compare as numbers do.
std::string epoch_text(std::uint64_t epoch) { return fmt::format("{:020}", epoch); }

std::uint64_t read_epoch_text(const std::string& key, const std::optional<std::string>& text) {
  if (!text) return 0;
  std::uint64_t epoch = 0;
  const auto [end, fault] = std::from_chars(text->data(), text->data() + text->size(), epoch);
  const bool is_number = fault == std::errc() && end == text->data() + text->size() && text->size() == 20;
  if (!is_number)
    throw etcd::StoreError(
        fmt::format("key '{}' is '{:.40}', not an epoch of 20 digits; nothing was done", key, *text));
  return epoch;
}

}  // namespace

Leadership::Leadership(etcd::LeaseStore& store, std::string prefix, int life_s, std::string description,
                       std::function<std::int64_t()> now_ns)
    : store_(store),
      epoch_key_(prefix + "/epoch"),
      last_key_(prefix + "/last"),
      place_key_(prefix + "/place"),
      life_s_(life_s),
      description_(std::move(description)),
      now_ns_(std::move(now_ns)) {}

std::uint64_t Leadership::draw_epoch(std::uint64_t least) {
  // Each try that fails is another server's draw.
  constexpr int kMostTries = 100;
  for (int i = 0; i < kMostTries; ++i) {
    const etcd::StoreResult read = store_.transact({.conditions = {}, .writes = {}, .reads = {epoch_key_, last_key_}});
    const std::optional<std::string>& newest = read.values.at(0);
    const std::uint64_t epoch =
        std::max({least, read_epoch_text(epoch_key_, newest) + 1, read_epoch_text(last_key_, read.values.at(1)) + 1});
    const etcd::StoreCondition is_unchanged =
        newest ? etcd::StoreCondition{.key = epoch_key_, .is = etcd::StoreCondition::Is::equal, .value = *newest}
               : etcd::StoreCondition{.key = epoch_key_};
    etcd::StoreTransaction draw{.conditions = {is_unchanged}, .writes = {{epoch_key_, epoch_text(epoch)}}, .reads = {}};
    // A key that is not there can be compared with nothing.
    if (!read.values.at(1)) {
      draw.conditions.push_back({.key = last_key_});
      draw.writes.push_back({last_key_, epoch_text(0)});
    }
    if (store_.transact(draw).is_done) return epoch_ = epoch;
  }
  throw etcd::StoreError(fmt::format("key '{}' was changed by others {} times while an epoch was drawn; none was drawn",
                                     epoch_key_, kMostTries));
}

void Leadership::renew_lease() {
  renewed_ns_ = now_ns_();
  if (lease_ != 0 && store_.renew(lease_)) return;
  lease_ = 0;
  lease_ = store_.grant(life_s_);
}

Leadership::PlaceState Leadership::read_state(const etcd::StoreResult& result) {
  last_epoch_ = read_epoch_text(last_key_, result.values.at(0));
  holder_ = result.values.at(1).value_or("");
  if (last_epoch_ > epoch_) return PlaceState::passed;
  if (!result.values.at(1)) return PlaceState::free;
  return last_epoch_ == epoch_ ? PlaceState::held : PlaceState::others;
}

/// Notes a confirmation whose lease is known to live: it was renewed just before.
Leadership::PlaceState Leadership::confirmed(PlaceState now) {
  if (now == PlaceState::held) confirmed_until_ns_ = renewed_ns_ + std::int64_t{life_s_} * 1'000'000'000 / 3;
  return now;
}

Leadership::PlaceState Leadership::take_if(etcd::StoreCondition last, bool has_to_be_free) {
  renew_lease();
  etcd::StoreTransaction taking{.conditions = {std::move(last)},
                                .writes = {{place_key_, description_, lease_}, {last_key_, epoch_text(epoch_)}},
                                .reads = {last_key_, place_key_}};
  if (has_to_be_free) taking.conditions.push_back({.key = place_key_});
  return confirmed(read_state(store_.transact(taking)));
}

Leadership::PlaceState Leadership::take() {
  return take_if({.key = last_key_, .is = etcd::StoreCondition::Is::less, .value = epoch_text(epoch_)}, true);
}

Leadership::PlaceState Leadership::succeed(std::uint64_t predecessor, TakeOverMode mode) {
  if (predecessor >= epoch_) return PlaceState::passed;
  const PlaceState now =
      take_if({.key = last_key_, .is = etcd::StoreCondition::Is::equal, .value = epoch_text(predecessor)},
              mode == TakeOverMode::strict);
  const bool is_anothers = now != PlaceState::held && last_epoch_ != predecessor;
  return is_anothers ? PlaceState::passed : now;
}

Leadership::PlaceState Leadership::confirm() {
  renewed_ns_ = now_ns_();
  const bool is_leased = lease_ != 0 && store_.renew(lease_);
  const PlaceState now = look();
  if (is_leased) return confirmed(now);
  // The key of a lease that is gone may be seen for a moment more.
  if (now == PlaceState::held) return PlaceState::free;
  if (now != PlaceState::free || last_epoch_ != epoch_) return now;
  return take_if({.key = last_key_, .is = etcd::StoreCondition::Is::equal, .value = epoch_text(epoch_)}, true);
}

Leadership::PlaceState Leadership::look() {
  return read_state(store_.transact({.conditions = {}, .writes = {}, .reads = {last_key_, place_key_}}));
}

void Leadership::resign() {
  confirmed_until_ns_ = 0;
  if (lease_ == 0) return;
  // One that may live still is renewed where the place is taken again: the key that is there may be its own.
  store_.revoke(lease_);
  lease_ = 0;
}

}  // namespace collided::engine::service
