#pragma once

#include <cstdint>
#include <mutex>
#include <span>
#include <string>
#include <unordered_map>

namespace collided::client {

/// The names of objects by id, from the server's messages. An id is slot + generation * 2^32, and a slot has one object
/// at a time, so the table keeps one name per slot. It is no larger than the server's, however many objects come and
/// go. Fences have separate slots. Any thread.
class Names {
 public:
  /// `packed` as in topics.hpp: one zero-terminated name per id.
  void learn(std::span<const std::uint64_t> ids, std::span<const std::uint8_t> packed);
  /// The name; "#<id>" for an unknown id.
  std::string name(std::uint64_t id) const;

 private:
  struct Entry {
    std::uint64_t id = 0;
    std::string name;
  };
  static std::uint64_t slot_of(std::uint64_t id);

  mutable std::mutex mutex_;
  std::unordered_map<std::uint64_t, Entry> by_slot_;
};

}  // namespace collided::client
