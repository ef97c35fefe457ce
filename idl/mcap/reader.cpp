#include "idl/mcap/reader.hpp"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>
#include <zlib.h>

#include <algorithm>
#include <cerrno>
#include <optional>
#include <stdexcept>

namespace collided::mcap {
namespace {

/// Takes values from the front of some bytes. After the first value that does not fit, good() is false and every value
/// is 0 or empty.
class Cursor {
 public:
  explicit Cursor(std::span<const std::byte> bytes) : bytes_(bytes) {}
  bool good() const { return good_; }
  std::size_t left() const { return bytes_.size(); }

  template <class Number>
  Number number() {
    Number value{};
    const std::span<const std::byte> from = raw(sizeof value);
    if (good_) std::memcpy(&value, from.data(), sizeof value);
    return value;
  }
  std::span<const std::byte> raw(std::uint64_t count) {
    if (!good_ || count > bytes_.size()) {
      good_ = false;
      return {};
    }
    const std::span<const std::byte> front = bytes_.first(count);
    bytes_ = bytes_.subspan(count);
    return front;
  }
  std::string text() {
    const std::span<const std::byte> from = raw(number<std::uint32_t>());
    return {reinterpret_cast<const char*>(from.data()), from.size()};
  }
  std::span<const std::byte> rest() { return raw(left()); }

 private:
  std::span<const std::byte> bytes_;
  bool good_ = true;
};

struct McapRecord {
  Opcode opcode{};
  std::span<const std::byte> content;
};

/// Takes the next whole record; nothing if the bytes end before its end.
std::optional<McapRecord> next_record(Cursor& bytes) {
  McapRecord record;
  record.opcode = static_cast<Opcode>(bytes.number<std::uint8_t>());
  record.content = bytes.raw(bytes.number<std::uint64_t>());
  return bytes.good() ? std::optional(record) : std::nullopt;
}

std::map<std::string, std::string> text_map(Cursor& cursor) {
  std::map<std::string, std::string> entries;
  Cursor map(cursor.raw(cursor.number<std::uint32_t>()));
  while (map.left() > 0 && map.good()) {
    const std::string key = map.text();
    const std::string value = map.text();
    if (map.good()) entries.emplace(key, value);
  }
  return entries;
}

class Reading {
 public:
  explicit Reading(std::span<const std::byte> bytes) : all_(bytes) {}

  Contents take() {
    const bool begins_well =
        all_.size() >= kMagic.size() && std::memcmp(all_.data(), kMagic.data(), kMagic.size()) == 0;
    if (!begins_well) return std::move(contents_);
    contents_.is_mcap = true;
    Cursor bytes(all_.subspan(kMagic.size()));
    while (bytes.left() > 0) {
      const std::size_t at = all_.size() - bytes.left();
      const std::optional<McapRecord> record = next_record(bytes);
      if (!record) {
        contents_.damage =
            "breaks off in the record at byte " + std::to_string(at) + "; what stands before it was read";
        break;
      }
      // The records after this one only repeat the channels and index the chunks, all of which have been read.
      if (record->opcode == Opcode::data_end) {
        contents_.complete = ends_well();
        break;
      }
      take(*record);
    }
    if (!contents_.complete && contents_.damage.empty()) {
      contents_.damage = "has no end: its writer was stopped; what stands there was read";
    }
    return std::move(contents_);
  }

 private:
  bool ends_well() const {
    return std::memcmp(all_.data() + all_.size() - kMagic.size(), kMagic.data(), kMagic.size()) == 0;
  }

  void take(const McapRecord& record) {
    switch (record.opcode) {
      case Opcode::schema: return take_schema(record.content);
      case Opcode::channel: return take_channel(record.content);
      case Opcode::message: return take_message(record.content);
      case Opcode::chunk: return take_chunk(record.content);
      case Opcode::metadata: return take_metadata(record.content);
      default: return;
    }
  }

  void take_schema(std::span<const std::byte> content) {
    Cursor cursor(content);
    const auto number = cursor.number<std::uint16_t>();
    Schema schema;
    schema.name = cursor.text();
    schema.encoding = cursor.text();
    schema.text = cursor.text();
    if (cursor.good()) contents_.schemas.emplace(number, std::move(schema));
  }

  void take_channel(std::span<const std::byte> content) {
    Cursor cursor(content);
    const auto number = cursor.number<std::uint16_t>();
    Channel channel;
    channel.schema = cursor.number<std::uint16_t>();
    channel.topic = cursor.text();
    channel.encoding = cursor.text();
    channel.metadata = text_map(cursor);
    if (cursor.good()) contents_.channels.emplace(number, std::move(channel));
  }

  void take_message(std::span<const std::byte> content) {
    Cursor cursor(content);
    Message message;
    message.head.channel = cursor.number<std::uint16_t>();
    message.head.number = cursor.number<std::uint32_t>();
    message.head.log_time = cursor.number<std::uint64_t>();
    message.head.publish_time = cursor.number<std::uint64_t>();
    message.data = cursor.rest();
    if (cursor.good() && contents_.channels.count(message.head.channel) > 0) {
      contents_.messages.push_back(message);
    } else {
      ++contents_.lost_messages;
    }
  }

  void take_chunk(std::span<const std::byte> content) {
    Cursor cursor(content);
    cursor.number<std::uint64_t>();  // its first and
    cursor.number<std::uint64_t>();  // last time
    const auto size = cursor.number<std::uint64_t>();
    const auto crc = cursor.number<std::uint32_t>();
    const std::string compression = cursor.text();
    const std::span<const std::byte> records = cursor.raw(cursor.number<std::uint64_t>());
    if (!cursor.good()) {
      ++contents_.bad_chunks;
    } else if (!compression.empty()) {
      ++contents_.compressed_chunks;
    } else if (size != records.size() || !checks(records, crc) || !tiles(records)) {
      ++contents_.bad_chunks;
    } else {
      Cursor inside(records);
      while (const std::optional<McapRecord> record = inside.left() > 0 ? next_record(inside) : std::nullopt) {
        if (record->opcode != Opcode::chunk) take(*record);
      }
    }
  }

  /// True if the checksum matches, or is 0 (unknown to the writer).
  static bool checks(std::span<const std::byte> records, std::uint32_t crc) {
    return crc == 0 || crc == crc32_z(0, reinterpret_cast<const Bytef*>(records.data()), records.size());
  }
  /// True if the bytes are whole records up to their end.
  static bool tiles(std::span<const std::byte> records) {
    Cursor inside(records);
    while (inside.left() > 0) {
      if (!next_record(inside)) return false;
    }
    return true;
  }

  void take_metadata(std::span<const std::byte> content) {
    Cursor cursor(content);
    const std::string name = cursor.text();
    std::map<std::string, std::string> entries = text_map(cursor);
    if (cursor.good()) contents_.metadata.emplace(name, std::move(entries));
  }

  std::span<const std::byte> all_;
  Contents contents_;
};

struct OpenedFile {
  explicit OpenedFile(const std::string& path) : descriptor(::open(path.c_str(), O_RDONLY | O_CLOEXEC)) {
    if (descriptor < 0) throw std::runtime_error(path + ": " + std::strerror(errno));
  }
  ~OpenedFile() { ::close(descriptor); }
  OpenedFile(const OpenedFile&) = delete;
  OpenedFile& operator=(const OpenedFile&) = delete;
  int descriptor;
};

}  // namespace

Contents read(std::span<const std::byte> bytes) { return Reading(bytes).take(); }

std::vector<std::byte> read_file(const std::string& path, std::uint64_t most_bytes) {
  const OpenedFile file(path);
  struct stat about {};
  if (::fstat(file.descriptor, &about) != 0) throw std::runtime_error(path + ": " + std::strerror(errno));
  if (!S_ISREG(about.st_mode)) throw std::runtime_error(path + ": is no file");
  const auto size = static_cast<std::uint64_t>(about.st_size);
  if (size > most_bytes) {
    throw std::runtime_error(path + ": has " + std::to_string(size) + " bytes; at most " + std::to_string(most_bytes) +
                             " are taken into memory. Nothing was read");
  }
  std::vector<std::byte> bytes(size);
  std::size_t have = 0;
  while (have < bytes.size()) {
    const ssize_t count = ::read(file.descriptor, bytes.data() + have, bytes.size() - have);
    if (count < 0 && errno == EINTR) continue;
    if (count < 0) throw std::runtime_error(path + ": " + std::strerror(errno));
    if (count == 0) break;  // the file was truncated meanwhile
    have += static_cast<std::size_t>(count);
  }
  bytes.resize(have);
  return bytes;
}

}  // namespace collided::mcap
