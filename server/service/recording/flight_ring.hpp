#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <memory>
#include <span>

#include "idl/cdr.hpp"
#include "idl/mcap/format.hpp"

namespace collided::engine::service {

/// Carries samples from the threads that take and answer to the thread that keeps them, each as the record of an MCAP
/// message. A sample without room is dropped and counted: recording never waits and never allocates.
///
/// threads  any may put, without a lock; one drains
/// source   the reservation of bounded multi-producer queues (Vyukov, "Bounded MPMC queue"), over bytes
class FlightRing {
 public:
  /// room_bytes  a power of two
  explicit FlightRing(std::size_t room_bytes)
      : room_(room_bytes), bytes_(std::make_unique<std::byte[]>(room_bytes)) {}  // zero: nothing is ready

  /// Records a sample, or drops it where there is no room. log_time, publish_time: ns since 1970.
  template <class T>
  void put(std::uint16_t channel, const T& sample, std::uint64_t log_time, std::uint64_t publish_time) noexcept {
    const std::size_t data = wire::cdr_size(sample);
    std::byte* record = reserve(mcap::kMessagePrefixBytes + data);
    if (record == nullptr) return;
    mcap::put_message_prefix(record, {channel, 0, log_time, publish_time}, data);
    wire::write_cdr(sample, {record + mcap::kMessagePrefixBytes, data});
    commit(record, mcap::kMessagePrefixBytes + data);
  }

  /// Calls keep(record) with every record that is ready, in order, and frees its room. One thread.
  template <class Keep>
  void drain(Keep&& keep) {
    std::uint64_t at = consumed_.load(std::memory_order_relaxed);
    while (const std::uint32_t slot = ready(at)) {
      const std::span<const std::byte> record = record_at(at);
      if (!record.empty()) keep(record);
      // Cleared before the room is freed: a header that is not written yet must read as zero.
      std::memset(&bytes_[at % room_], 0, slot);
      at += slot;
      consumed_.store(at, std::memory_order_release);
    }
  }
  /// Calls see(record) with every record that is ready and leaves them where they are. Safe in a signal handler.
  template <class See>
  void peek(See&& see) const {
    std::uint64_t at = consumed_.load(std::memory_order_acquire);
    const std::uint64_t end = at + room_;
    for (std::uint32_t slot = ready(at); slot != 0 && at + slot <= end; slot = ready(at)) {
      const std::span<const std::byte> record = record_at(at);
      if (!record.empty()) see(record);
      at += slot;
      if (at == end) return;
    }
  }

  /// Samples dropped since the start.
  std::uint64_t dropped() const { return dropped_.load(std::memory_order_relaxed); }

 private:
  /// Stands before each record. slot_bytes: distance to the next header; 0 until the record is whole. record_bytes:
  /// length of the record; 0: none, since the room up to the end of the ring was too small.
  struct SlotHeader {
    std::uint32_t slot_bytes;
    std::uint32_t record_bytes;
  };
  static constexpr std::size_t kAlignment = 8;  // of headers, so that they can be atomic
  static std::size_t slot_of(std::size_t record_bytes) {
    return (sizeof(SlotHeader) + record_bytes + kAlignment - 1) / kAlignment * kAlignment;
  }
  SlotHeader& header(std::uint64_t at) const { return *reinterpret_cast<SlotHeader*>(&bytes_[at % room_]); }
  std::uint32_t ready(std::uint64_t at) const {
    return std::atomic_ref(header(at).slot_bytes).load(std::memory_order_acquire);
  }
  std::span<const std::byte> record_at(std::uint64_t at) const {
    return {&bytes_[at % room_] + sizeof(SlotHeader), header(at).record_bytes};
  }

  std::byte* reserve(std::size_t record_bytes) noexcept {
    const std::size_t slot = slot_of(record_bytes);
    std::uint64_t at = reserved_.load(std::memory_order_relaxed);
    std::size_t skipped = 0;
    do {
      // A record never wraps around: where the end of the ring is too near, the rest of it becomes an empty slot.
      const std::size_t to_end = room_ - at % room_;
      skipped = to_end < slot ? to_end : 0;
      if (slot > room_ / 4 || at + skipped + slot - consumed_.load(std::memory_order_acquire) > room_) {
        dropped_.fetch_add(1, std::memory_order_relaxed);
        return nullptr;
      }
    } while (!reserved_.compare_exchange_weak(at, at + skipped + slot, std::memory_order_relaxed));
    if (skipped > 0)
      std::atomic_ref(header(at).slot_bytes).store(static_cast<std::uint32_t>(skipped), std::memory_order_release);
    return &bytes_[(at + skipped) % room_] + sizeof(SlotHeader);
  }
  void commit(std::byte* record, std::size_t record_bytes) noexcept {
    SlotHeader& own = *reinterpret_cast<SlotHeader*>(record - sizeof(SlotHeader));
    own.record_bytes = static_cast<std::uint32_t>(record_bytes);
    std::atomic_ref(own.slot_bytes).store(static_cast<std::uint32_t>(slot_of(record_bytes)), std::memory_order_release);
  }

  const std::size_t room_;
  std::unique_ptr<std::byte[]> bytes_;
  std::atomic<std::uint64_t> reserved_{0};
  std::atomic<std::uint64_t> consumed_{0};
  std::atomic<std::uint64_t> dropped_{0};
};

}  // namespace collided::engine::service
