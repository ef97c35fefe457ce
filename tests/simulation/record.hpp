#pragma once

#include <cstdint>
#include <cstdio>
#include <cstring>
#include <span>
#include <string>
#include <type_traits>
#include <vector>

namespace collided::simulation {

/// What the world's side tells the watchers' side through a pipe: messages of one kind, the virtual time and a payload.
/// The two sides are programs of their own, since the engine's and the library's types share their names.
enum class Kind : std::uint8_t {
  run,       // seed, and whether it is of a fleet: a new run begins
  frame,     // as EventFrame of collided.idl
  expected,  // likewise, of a server that hears what the fleet hears, and never fails
  shard,     // as ContactShard
  bookmark,  // as Status
  calm,      // from here on the line loses nothing
  truth,     // pairs of names that touch; ends the run
  end,       // counts of the world's side; ends the record
};

struct Header {
  Kind kind = Kind::run;
  std::int64_t time_ns = 0;
  std::uint64_t bytes = 0;
};

/// A payload being written: numbers as they lie in memory, vectors with their length before them.
class Payload {
 public:
  template <class T>
  void put(const T& value) {
    static_assert(std::is_trivially_copyable_v<T>);
    const auto* bytes = reinterpret_cast<const std::uint8_t*>(&value);
    bytes_.insert(bytes_.end(), bytes, bytes + sizeof value);
  }
  template <class T>
  void put(const std::vector<T>& values) {
    put(static_cast<std::uint64_t>(values.size()));
    const auto* bytes = reinterpret_cast<const std::uint8_t*>(values.data());
    bytes_.insert(bytes_.end(), bytes, bytes + values.size() * sizeof(T));
  }
  /// Writes it out and is empty again. False where the other side has gone.
  bool send(Kind kind, std::int64_t time_ns, std::FILE* to) {
    const Header header{kind, time_ns, bytes_.size()};
    const bool sent = std::fwrite(&header, sizeof header, 1, to) == 1 &&
                      std::fwrite(bytes_.data(), 1, bytes_.size(), to) == bytes_.size();
    bytes_.clear();
    return sent;
  }

 private:
  std::vector<std::uint8_t> bytes_;
};

/// A message being read. Reading beyond its end gives zeros and is noted.
class Message {
 public:
  /// False at the end of the record.
  bool receive(std::FILE* from) {
    at_ = 0;
    is_short_ = false;
    if (std::fread(&header_, sizeof header_, 1, from) != 1) return false;
    bytes_.resize(header_.bytes);
    return std::fread(bytes_.data(), 1, bytes_.size(), from) == bytes_.size();
  }
  Kind kind() const { return header_.kind; }
  std::int64_t time_ns() const { return header_.time_ns; }
  bool is_short() const { return is_short_; }

  template <class T>
  T get() {
    T value{};
    take(&value, sizeof value);
    return value;
  }
  template <class T>
  std::vector<T> get_all() {
    const auto count = get<std::uint64_t>();
    std::vector<T> values(is_short_ || count > bytes_.size() / sizeof(T) ? 0 : count);
    take(values.data(), values.size() * sizeof(T));
    return values;
  }

 private:
  void take(void* to, std::size_t bytes) {
    is_short_ = is_short_ || bytes > bytes_.size() - at_;
    if (is_short_ || bytes == 0) return;
    std::memcpy(to, bytes_.data() + at_, bytes);
    at_ += bytes;
  }

  Header header_;
  std::vector<std::uint8_t> bytes_;
  std::size_t at_ = 0;
  bool is_short_ = false;
};

}  // namespace collided::simulation
