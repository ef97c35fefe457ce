#pragma once

#include <sys/mman.h>

#include <algorithm>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <new>
#include <span>

#include "idl/cdr.hpp"
#include "idl/mcap/format.hpp"

namespace collided::engine::service {

/// Carries samples from the threads that receive and answer to the thread that keeps them, each as the record of an
/// MCAP message. A sample without room is dropped and counted: recording never waits and never allocates.
///
/// threads  any may put, without a lock; one drains
/// source   the reservation of bounded multi-producer queues (Vyukov, "Bounded MPMC queue"), over bytes
class FlightRing {
 public:
  /// room_bytes  a power of two, several pages
  explicit FlightRing(std::size_t room_bytes) : room_(room_bytes), bytes_(zero_pages(room_bytes)) {}
  ~FlightRing() { munmap(bytes_, room_); }
  FlightRing(const FlightRing&) = delete;
  FlightRing& operator=(const FlightRing&) = delete;

  /// Records a sample, or drops it if there is no room. log_time, publish_time: ns since 1970.
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
  ///
  /// gives_back  whether freed memory is returned to the system: for low rates
  template <class Keep>
  void drain(bool gives_back, Keep&& keep) {
    std::uint64_t at = drained_.load(std::memory_order_relaxed);
    while (const std::uint32_t slot = ready(at)) {
      const std::span<const std::byte> record = record_at(at);
      if (!record.empty()) keep(record);
      at += slot;
      drained_.store(at, std::memory_order_release);
      free_until(at, gives_back);
    }
  }
  /// Whether the ring is full enough that it should be drained soon.
  bool is_filling() const {
    return reserved_.load(std::memory_order_relaxed) - freed_.load(std::memory_order_relaxed) > room_ / 8;
  }
  /// Calls see(record) with every record that is ready and leaves them where they are. Safe in a signal handler.
  template <class See>
  void peek(See&& see) const {
    std::uint64_t at = drained_.load(std::memory_order_acquire);
    const std::uint64_t end = freed_.load(std::memory_order_acquire) + room_;
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
  /// Precedes each record. slot_bytes: distance to the next header; 0 until the record is whole. record_bytes: length
  /// of the record; 0: none, since the room up to the end of the ring was too small.
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

  /// Frees the room of whole pages. It is cleared first, since an unwritten header must read as zero.
  void free_until(std::uint64_t at, bool gives_back) {
    const std::uint64_t freed = freed_.load(std::memory_order_relaxed);
    const std::size_t pages = (at - freed) / kPageBytes * kPageBytes;
    if (pages == 0) return;
    const std::size_t to_end = std::min(pages, room_ - freed % room_);
    clear(&bytes_[freed % room_], to_end, gives_back);
    clear(bytes_, pages - to_end, gives_back);
    freed_.store(freed + pages, std::memory_order_release);
  }
  static void clear(std::byte* from, std::size_t byte_count, bool gives_back) {
    // Private pages returned to the system read as zero.
    if (!gives_back || madvise(from, byte_count, MADV_DONTNEED) != 0) std::memset(from, 0, byte_count);
  }
  static std::byte* zero_pages(std::size_t byte_count) {
    void* pages = mmap(nullptr, byte_count, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
    if (pages == MAP_FAILED) throw std::bad_alloc();
    return static_cast<std::byte*>(pages);
  }

  std::byte* reserve(std::size_t record_bytes) noexcept {
    const std::size_t slot = slot_of(record_bytes);
    std::uint64_t at = reserved_.load(std::memory_order_relaxed);
    std::size_t skipped = 0;
    do {
      // A record never wraps around: if the end of the ring is too near, the rest of it becomes an empty slot.
      const std::size_t to_end = room_ - at % room_;
      skipped = to_end < slot ? to_end : 0;
      if (slot > room_ / 4 || at + skipped + slot - freed_.load(std::memory_order_acquire) > room_) {
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

  static constexpr std::size_t kPageBytes = 4'096;

  const std::size_t room_;
  std::byte* const bytes_;  // zero: nothing is ready
  std::atomic<std::uint64_t> reserved_{0};
  std::atomic<std::uint64_t> drained_{0};
  std::atomic<std::uint64_t> freed_{0};  // less than a page behind
  std::atomic<std::uint64_t> dropped_{0};
};

}  // namespace collided::engine::service
