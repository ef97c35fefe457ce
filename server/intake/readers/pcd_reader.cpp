#include <fmt/format.h>

#include <array>
#include <bit>
#include <cmath>
#include <limits>
#include <optional>

#include "server/intake/limits.hpp"
#include "server/intake/readers/byte_order.hpp"
#include "server/intake/readers/reading.hpp"
#include "server/intake/readers/text_cursor.hpp"

namespace collided::engine {
namespace {

/// One column of a PCD file.
struct PcdField {
  std::string name;
  std::uint64_t bytes = 0;
  char type = 'F';
  std::uint64_t count = 1;
  std::uint64_t offset = 0;       // bytes within a point
  std::uint64_t word_offset = 0;  // numbers within a line
};

struct PcdHeader {
  std::vector<PcdField> fields;
  std::uint64_t point_count = 0;
  std::uint64_t point_bytes = 0;
  std::string data;
  std::array<std::size_t, 3> axes{};  // which fields are x y z
};

/// Reads the header of a PCD file.
/// source    "The PCD (Point Cloud Data) file format", Point Cloud Library documentation, version 0.7
class PcdHeaderReader {
 public:
  PcdHeaderReader(const Reading& reading, TextCursor& cursor) : reading_(reading), cursor_(cursor) {}

  PcdHeader read() {
    while (header_.data.empty()) {
      if (!cursor_.find_word()) refuse(reading_, "the PCD header ends without its DATA line");
      const std::string key(cursor_.word());
      take_line(key);
      if (header_.data.empty()) cursor_.next_line();
    }
    finish();
    return std::move(header_);
  }

 private:
  void take_line(const std::string& key) {
    if (key == "FIELDS" || key == "COLUMNS") {
      while (!cursor_.at_line_end()) header_.fields.push_back({.name = std::string(cursor_.word())});
      if (header_.fields.empty() || header_.fields.size() > kMaxFields)
        cursor_.complain(fmt::format("{} fields, allowed are 1 to {}", header_.fields.size(), kMaxFields));
    } else if (key == "SIZE") {
      for (PcdField& field : header_.fields) field.bytes = whole("size of a field", 1, 8);
    } else if (key == "TYPE") {
      for (PcdField& field : header_.fields) field.type = type();
    } else if (key == "COUNT") {
      for (PcdField& field : header_.fields) field.count = whole("count of a field", 1, 1 << 20);
    } else if (key == "POINTS") {
      header_.point_count = whole("number of points", 0, kMaxVertices);
      has_count_ = true;
    } else if (key == "WIDTH") {
      width_ = whole("width", 0, kMaxVertices);
    } else if (key == "HEIGHT") {
      height_ = whole("height", 0, kMaxVertices);
    } else if (key == "DATA") {
      header_.data = cursor_.word();
      if (header_.data.empty()) cursor_.complain("DATA of no kind");
    } else if (key != "VERSION" && key != "VIEWPOINT") {
      cursor_.complain(fmt::format("{} is no word of a PCD header", in_quotes(key)));
    }
  }

  std::uint64_t whole(const char* what, std::int64_t least, std::int64_t most) {
    const std::int64_t value = cursor_.integer(what);
    if (value < least || value > most)
      cursor_.complain(fmt::format("{} is {}, allowed are {} to {}", what, value, least, most));
    return static_cast<std::uint64_t>(value);
  }

  char type() {
    const std::string_view word = cursor_.word();
    if (word != "F" && word != "I" && word != "U")
      cursor_.complain(fmt::format("type {}, allowed are F, I and U", in_quotes(word)));
    return word[0];
  }

  void finish() {
    if (header_.fields.empty()) refuse(reading_, "the PCD header names no FIELDS");
    if (!has_count_) header_.point_count = width_ * height_;
    if (header_.point_count > kMaxCloudPoints) {
      refuse(reading_,
             fmt::format("{} points, the most that a cloud may have are {}", header_.point_count, kMaxCloudPoints));
    }
    std::uint64_t words = 0;
    for (PcdField& field : header_.fields) {
      field.offset = header_.point_bytes;
      field.word_offset = words;
      header_.point_bytes += field.bytes * field.count;
      words += field.count;
    }
    for (std::size_t axis = 0; axis < 3; ++axis) header_.axes[axis] = column(std::string(1, "xyz"[axis]));
    for (const std::size_t number : header_.axes) check_type(header_.fields[number]);
  }

  std::size_t column(const std::string& name) const {
    for (std::size_t i = 0; i < header_.fields.size(); ++i) {
      const PcdField& field = header_.fields[i];
      if (field.name == name) return i;
    }
    refuse(reading_, fmt::format("no field {}; a cloud needs x, y and z", name));
  }

  void check_type(const PcdField& field) const {
    const bool is_float = field.type == 'F' && (field.bytes == 4 || field.bytes == 8);
    const bool is_whole = field.type != 'F' && (field.bytes == 1 || field.bytes == 2 || field.bytes == 4);
    if (!is_float && !is_whole)
      refuse(reading_, fmt::format("field {} is of type {}{}", field.name, field.type, 8 * field.bytes));
  }

  static constexpr std::size_t kMaxFields = 256;
  const Reading& reading_;
  TextCursor& cursor_;
  PcdHeader header_;
  std::uint64_t width_ = 0;
  std::uint64_t height_ = 1;
  bool has_count_ = false;
};

double value_at(const char* bytes, const PcdField& field) {
  constexpr std::endian kOrder = std::endian::little;
  if (field.type == 'F')
    return field.bytes == 8 ? number_at<double>(bytes, kOrder) : static_cast<double>(number_at<float>(bytes, kOrder));
  const bool is_signed = field.type == 'I';
  switch (field.bytes) {
    case 1: return is_signed ? number_at<std::int8_t>(bytes, kOrder) : number_at<std::uint8_t>(bytes, kOrder);
    case 2: return is_signed ? number_at<std::int16_t>(bytes, kOrder) : number_at<std::uint16_t>(bytes, kOrder);
    default:
      // Each is converted separately: the common type of the two would be unsigned.
      return is_signed ? static_cast<double>(number_at<std::int32_t>(bytes, kOrder))
                       : number_at<std::uint32_t>(bytes, kOrder);
  }
}

/// Unpacks LZF. Nothing if the result does not have the stated size.
/// source    LibLZF's stream format: a byte below 32 starts a run of one more than that many literals; else three bits
///           of length and thirteen of distance back, with one more byte of length if the three are all set
std::optional<std::string> unpack_lzf(std::string_view packed, std::size_t size) {
  std::string out;
  out.reserve(size);
  for (std::size_t at = 0; at < packed.size();) {
    const auto control = static_cast<std::uint8_t>(packed[at++]);
    if (control < 32) {
      const std::size_t run = control + std::size_t{1};
      if (run > packed.size() - at || run > size - out.size()) return std::nullopt;
      out.append(packed.substr(at, run));
      at += run;
      continue;
    }
    std::size_t length = control >> 5;
    if (length == 7) {
      if (at == packed.size()) return std::nullopt;
      length += static_cast<std::uint8_t>(packed[at++]);
    }
    if (at == packed.size()) return std::nullopt;
    const std::size_t back = (std::size_t{control & 31u} << 8) + static_cast<std::uint8_t>(packed[at++]) + 1;
    length += 2;
    if (back > out.size() || length > size - out.size()) return std::nullopt;
    for (std::size_t from = out.size() - back; length > 0; --length) out += out[from++];
  }
  if (out.size() != size) return std::nullopt;
  return out;
}

class PcdReader {
 public:
  explicit PcdReader(const Reading& reading)
      : reading_(reading),
        cursor_(reading, {reading.begin(), reading.bytes.size()}, TextCursor::LineEnd::newline_or_comment, false) {}

  Scene read() {
    header_ = PcdHeaderReader(reading_, cursor_).read();
    cursor_.next_line();
    const std::string& data = header_.data;
    if (data == "ascii") read_text();
    else if (data == "binary") read_binary();
    else if (data == "binary_compressed") read_compressed();
    else
      refuse(reading_, fmt::format("DATA {}, allowed are ascii, binary and binary_compressed",
                                   in_quotes(std::string_view(data))));
    if (cloud_.shape.primitives.empty()) refuse(reading_, "no points");
    if (missing_count_ > 0) {
      reading_.report.refused.push_back(fmt::format("{} points that are NaN (not measured) left out", missing_count_));
    }
    Scene scene;
    scene.objects.push_back(std::move(cloud_));
    return scene;
  }

 private:
  void add(const Vec3& point, std::uint64_t number) {
    // In an organized cloud this is a pixel without a measurement.
    if (point.hasNaN()) {
      ++missing_count_;
      return;
    }
    if (!point.allFinite())
      refuse(reading_, fmt::format("point {} is ({}, {}, {})", number, point[0], point[1], point[2]));
    cloud_.shape.primitives.push_back(Sphere{.center = point});
  }

  void read_text() {
    for (std::uint64_t i = 0; i < header_.point_count; ++i) {
      if (!cursor_.find_word())
        refuse(reading_, fmt::format("the file ends after {} of {} points", i, header_.point_count));
      Vec3 point;
      std::uint64_t word = 0;
      std::uint64_t found = 0;
      for (; !cursor_.at_line_end(); ++word) {
        const int axis = axis_of(word);
        if (axis < 0) {
          cursor_.word();
        } else {
          point[axis] = coordinate();
          ++found;
        }
      }
      if (found < 3) cursor_.complain("a point takes three coordinates");
      add(point, i);
    }
  }

  int axis_of(std::uint64_t word) const {
    for (int axis = 0; axis < 3; ++axis) {
      if (header_.fields[header_.axes[axis]].word_offset == word) return axis;
    }
    return -1;
  }

  double coordinate() {
    TextCursor ahead = cursor_;
    const std::string_view word = ahead.word();
    if (word == "nan" || word == "NaN" || word == "-nan") {
      cursor_ = ahead;
      return std::numeric_limits<double>::quiet_NaN();
    }
    return cursor_.finite_number("point coordinate");
  }

  std::string_view rest() const {
    return {cursor_.place(), static_cast<std::size_t>(reading_.end() - cursor_.place())};
  }

  void check_room(std::uint64_t needed, std::uint64_t there) const {
    if (there < needed) {
      refuse(reading_, fmt::format("{} points need {} bytes, the file has {}", header_.point_count, needed, there));
    }
  }

  void read_binary() {
    const std::string_view bytes = rest();
    check_room(header_.point_count * header_.point_bytes, bytes.size());
    for (std::uint64_t i = 0; i < header_.point_count; ++i) {
      add(point_at([&](const PcdField& field) { return bytes.data() + i * header_.point_bytes + field.offset; }), i);
    }
  }

  /// Reads compressed data, which has all values of one field before those of the next.
  void read_compressed() {
    const std::string_view bytes = rest();
    check_room(8, bytes.size());
    const auto packed = number_at<std::uint32_t>(bytes.data(), std::endian::little);
    const auto size = number_at<std::uint32_t>(bytes.data() + 4, std::endian::little);
    check_room(std::uint64_t{packed} + 8, bytes.size());
    check_room(header_.point_count * header_.point_bytes, size);
    // A byte of LZF expands to at most 132.
    if (size / 132 > packed) refuse(reading_, fmt::format("{} bytes cannot hold {} unpacked", packed, size));
    const std::optional<std::string> plain = unpack_lzf(bytes.substr(8, packed), size);
    if (!plain) refuse(reading_, fmt::format("the packed points do not unpack to {} bytes", size));
    for (std::uint64_t i = 0; i < header_.point_count; ++i) {
      add(point_at([&](const PcdField& field) {
            return plain->data() + header_.point_count * field.offset + i * field.bytes * field.count;
          }),
          i);
    }
  }

  template <class PlaceOf>
  Vec3 point_at(PlaceOf&& place_of) const {
    Vec3 point;
    for (int axis = 0; axis < 3; ++axis) {
      const PcdField& field = header_.fields[header_.axes[axis]];
      point[axis] = value_at(place_of(field), field);
    }
    return point;
  }

  const Reading& reading_;
  TextCursor cursor_;
  PcdHeader header_;
  SceneObject cloud_;
  std::uint64_t missing_count_ = 0;
};

}  // namespace

Scene read_pcd(const Reading& reading) { return PcdReader(reading).read(); }

}  // namespace collided::engine
