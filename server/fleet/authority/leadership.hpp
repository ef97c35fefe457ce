#pragma once

#include <cstdint>
#include <functional>
#include <string>

#include "idl/etcd/lease_store.hpp"

namespace collided::engine::service {

/// What may take the primary's place, and when.
///
/// strict  once the lease of the one that had it is gone
/// fast    at once; that one may go on until it asks next
enum class TakeOverMode : std::uint8_t { strict, fast };

/// Who is the primary of a namespace, as a store of leases has it. Two keys and one counter:
///
///   PREFIX/epoch   the newest epoch that was given out
///   PREFIX/last    the epoch of the server that took the place last
///   PREFIX/place   who has the place; goes with that server's lease
///
/// An epoch is given out once, by a compare-and-swap, and is greater than all before it. The place goes by another one
/// to who knows whose place it takes: of two that take the same one's place one is refused. Nobody but the last one who
/// took it can have it again with the same epoch, which it can as long as nobody has taken it since.
///
/// Knows neither threads nor network. Each call may throw StoreError; then what it asked for may have been done, and is
/// found at the next call.
///
/// threads  one
class Leadership {
 public:
  /// description  the value of PREFIX/place, for people
  /// now_ns       steady clock
  Leadership(etcd::LeaseStore& store, std::string prefix, int life_s, std::string description,
             std::function<std::int64_t()> now_ns);

  /// Draws this server's epoch, at least that one: at the start, and a greater one while it does not have the place.
  std::uint64_t draw_epoch(std::uint64_t least);
  std::uint64_t epoch() const { return epoch_; }

  enum class PlaceState : std::uint8_t {
    held,    // this server has the place, at least until confirmed_until_ns()
    free,    // nobody has it
    others,  // another one has it
    passed,  // another one has or had it, and this server may not succeed it
  };
  /// Takes the place if nobody has it; of any server whose epoch is lower.
  PlaceState take();
  /// Takes the place of that one. strict: waits until its lease is gone, and is to be called again while it is not.
  PlaceState succeed(std::uint64_t predecessor, TakeOverMode mode);
  /// Renews the lease and asks whether the place is this server's still. Takes it again where the lease is gone and
  /// nobody else has taken it since.
  PlaceState confirm();
  /// Who has the place, without changing anything.
  PlaceState look();
  /// Gives the place up.
  void resign();

  /// Until when the newest confirmation lets this server serve, steady clock: a third of the lease's life after the
  /// question was asked. The other two thirds are for clocks that run apart, for what is written just then, and for a
  /// store whose leader has just changed.
  std::int64_t confirmed_until_ns() const { return confirmed_until_ns_; }
  /// The epoch of the one that took the place last, as of the last call, and what PREFIX/place said.
  std::uint64_t last_epoch() const { return last_epoch_; }
  const std::string& holder() const { return holder_; }

 private:
  void renew_lease();
  PlaceState take_if(etcd::StoreCondition last, bool has_to_be_free);
  PlaceState read_state(const etcd::StoreResult& result);
  PlaceState confirmed(PlaceState now);

  etcd::LeaseStore& store_;
  const std::string epoch_key_;
  const std::string last_key_;
  const std::string place_key_;
  const int life_s_;
  const std::string description_;
  const std::function<std::int64_t()> now_ns_;
  std::uint64_t epoch_ = 0;
  std::int64_t lease_ = 0;       // 0: none
  std::int64_t renewed_ns_ = 0;  // when the newest renewal was asked for
  std::int64_t confirmed_until_ns_ = 0;
  std::uint64_t last_epoch_ = 0;
  std::string holder_;
};

}  // namespace collided::engine::service
