#include <fmt/format.h>

#include <array>
#include <cmath>
#include <type_traits>

#include "server/intake/readers/byte_order.hpp"
#include "server/intake/readers/ply_header.hpp"
#include "server/intake/readers/polygons.hpp"
#include "server/intake/readers/reading.hpp"
#include "server/intake/readers/text_cursor.hpp"

namespace collided::engine {
namespace {

/// The rows of a PLY file as text.
class TextRows {
 public:
  TextRows(const Reading& reading, const PlyHeader& header)
      : cursor_(reading, {reading.begin() + header.body_byte, reading.bytes.size() - header.body_byte},
                TextCursor::LineEnd::newline, false) {}

  const char* place() const { return cursor_.place(); }
  const char* begin_row() {
    cursor_.find_word();
    return cursor_.place();
  }
  double coordinate(PlyType) {
    cursor_.find_word();
    return cursor_.finite_number("vertex coordinate");
  }
  std::int64_t whole_number(PlyType) {
    cursor_.find_word();
    return cursor_.integer("whole number");
  }
  void skip(PlyType, std::int64_t count) {
    for (std::int64_t i = 0; i < count; ++i) {
      if (!cursor_.find_word()) { complain("the file ends inside a row"); }
      cursor_.word();
    }
  }
  [[noreturn]] void complain(const std::string& what) const { cursor_.complain(what); }

 private:
  TextCursor cursor_;
};

/// The rows of a PLY file as bytes.
class ByteRows {
 public:
  ByteRows(const Reading& reading, const PlyHeader& header)
      : reading_(reading),
        at_(reading.begin() + header.body_byte),
        order_(header.format == PlyFormat::big_endian ? std::endian::big : std::endian::little) {}

  const char* place() const { return at_; }
  const char* begin_row() const { return at_; }
  /// Reads a list of three 4-byte numbers counted by one byte, as in nearly every file, in one step. False, without
  /// reading anything, if the row is anything else, or the file ends in it.
  bool take_triangle(const PlyElement& element, std::array<std::int64_t, 3>& numbers) {
    constexpr std::size_t kBytes = 1 + 3 * sizeof(std::int32_t);
    if (static_cast<std::size_t>(reading_.end() - at_) < kBytes || *at_ != 3) return false;
    const bool is_signed = element.properties.front().type == PlyType::int32;
    for (std::size_t i = 0; i < 3; ++i) {
      const auto bits = number_at<std::uint32_t>(at_ + 1 + i * sizeof(std::uint32_t), order_);
      numbers[i] = is_signed ? std::int64_t{static_cast<std::int32_t>(bits)} : std::int64_t{bits};
    }
    at_ += kBytes;
    return true;
  }
  double coordinate(PlyType type) {
    if (type != PlyType::float32 && type != PlyType::float64) { return static_cast<double>(whole_number(type)); }
    const double value = type == PlyType::float32 ? static_cast<double>(take<float>()) : take<double>();
    if (!std::isfinite(value)) { complain(fmt::format("vertex coordinate {} is not finite", value)); }
    return value;
  }
  std::int64_t whole_number(PlyType type) {
    switch (type) {
      case PlyType::int8: return take<std::int8_t>();
      case PlyType::uint8: return take<std::uint8_t>();
      case PlyType::int16: return take<std::int16_t>();
      case PlyType::uint16: return take<std::uint16_t>();
      case PlyType::int32: return take<std::int32_t>();
      case PlyType::uint32: return take<std::uint32_t>();
      case PlyType::float32:
      case PlyType::float64: break;
    }
    complain("a number that is not whole counts or numbers nothing");
  }
  void skip(PlyType type, std::int64_t count) {
    const auto room = static_cast<std::size_t>(reading_.end() - at_) / byte_count(type);
    if (count < 0 || static_cast<std::uint64_t>(count) > room) {
      complain(fmt::format("list of {} numbers, the file has room for {}", count, room));
    }
    at_ += static_cast<std::size_t>(count) * byte_count(type);
  }
  [[noreturn]] void complain(const std::string& what) const {
    refuse_byte(reading_, static_cast<std::size_t>(at_ - reading_.begin()), what);
  }

 private:
  template <class Number>
  Number take() {
    if (static_cast<std::size_t>(reading_.end() - at_) < sizeof(Number)) { complain("the file ends inside a row"); }
    const auto value = number_at<Number>(at_, order_);
    at_ += sizeof(Number);
    return value;
  }

  const Reading& reading_;
  const char* at_;
  std::endian order_;
};

template <class Rows>
class PlyBodyReader {
 public:
  PlyBodyReader(const Reading& reading, const PlyHeader& header)
      : reading_(reading),
        header_(header),
        rows_(reading, header),
        polygons_(reading, header.format == PlyFormat::text ? Polygons::Places::lines : Polygons::Places::bytes) {}

  Scene read() {
    for (const PlyElement& element : header_.elements) {
      if (element.properties.empty()) { continue; }
      if (element.name == "vertex") {
        read_vertices(element);
      } else if (element.name == "face") {
        read_lists(element, false);
      } else if (element.name == "tristrips") {
        read_lists(element, true);
      } else {
        skip_rows(element);
      }
    }
    if (!has_vertices_) { refuse(reading_, "the header has no element 'vertex'"); }
    for (const Waiting& face : waiting_) { add(face.numbers, face.is_strip, face.place); }
    polygons_.report();
    return polygons_.take_scene();
  }

 private:
  struct Waiting {
    std::vector<std::int64_t> numbers;
    bool is_strip;
    const char* place;
  };

  void read_vertices(const PlyElement& element) {
    check_vertex_count(reading_, element.row_count);
    const int axes[3] = {element.find("x"), element.find("y"), element.find("z")};
    for (int axis = 0; axis < 3; ++axis) {
      if (axes[axis] < 0 || element.properties[static_cast<std::size_t>(axes[axis])].count_type) {
        refuse(reading_, fmt::format("element 'vertex' has no number '{}'", "xyz"[axis]));
      }
    }
    polygons_.vertices().reserve(element.row_count);
    for (std::uint64_t i = 0; i < element.row_count; ++i) {
      Vec3 vertex;
      for (int k = 0; k < static_cast<int>(element.properties.size()); ++k) {
        const PlyProperty& property = element.properties[static_cast<std::size_t>(k)];
        const auto axis = std::find(axes, axes + 3, k) - axes;
        if (axis < 3) {
          vertex[axis] = rows_.coordinate(property.type);
        } else {
          skip_property(property);
        }
      }
      polygons_.vertices().push_back(vertex);
      tell_row(i);
    }
    has_vertices_ = true;
  }

  void read_lists(const PlyElement& element, bool is_strip) {
    int list = element.find("vertex_indices");
    list = list < 0 ? element.find("vertex_index") : list;
    if (list < 0 || !element.properties[static_cast<std::size_t>(list)].count_type) {
      refuse(reading_, fmt::format("element {} has no list 'vertex_indices'", in_quotes(element.name)));
    }
    if (!is_strip) { check_triangle_count(reading_, element.row_count); }
    std::vector<std::int64_t> numbers;
    std::array<std::int64_t, 3> triangle;
    const bool may_be_triangles = has_vertices_ && !is_strip && is_plain_list(element);
    for (std::uint64_t i = 0; i < element.row_count; ++i) {
      const char* place = rows_.begin_row();
      if (may_be_triangles && take_triangle(element, triangle)) {
        polygons_.add_triangle({polygons_.vertex_number(triangle[0], place),
                                polygons_.vertex_number(triangle[1], place),
                                polygons_.vertex_number(triangle[2], place)});
        tell_row(i);
        continue;
      }
      for (int k = 0; k < static_cast<int>(element.properties.size()); ++k) {
        const PlyProperty& property = element.properties[static_cast<std::size_t>(k)];
        if (k == list) {
          read_numbers(property, numbers);
        } else {
          skip_property(property);
        }
      }
      if (has_vertices_) {
        add(numbers, is_strip, place);
      } else {
        waiting_.push_back({numbers, is_strip, place});
      }
      tell_row(i);
    }
  }

  /// One list of 4-byte whole numbers, counted by a byte, and nothing else.
  static bool is_plain_list(const PlyElement& element) {
    const PlyProperty& list = element.properties.front();
    return element.properties.size() == 1 && list.count_type == PlyType::uint8 &&
           (list.type == PlyType::int32 || list.type == PlyType::uint32);
  }
  bool take_triangle(const PlyElement& element, std::array<std::int64_t, 3>& numbers) {
    if constexpr (std::is_same_v<Rows, ByteRows>) return rows_.take_triangle(element, numbers);
    else return false;
  }

  void read_numbers(const PlyProperty& property, std::vector<std::int64_t>& numbers) {
    const std::int64_t count = rows_.whole_number(*property.count_type);
    if (count < 0) { rows_.complain(fmt::format("list of {} numbers", count)); }
    numbers.clear();
    for (std::int64_t i = 0; i < count; ++i) {  // ends with the file at the latest
      numbers.push_back(rows_.whole_number(property.type));
    }
  }

  void add(const std::vector<std::int64_t>& numbers, bool is_strip, const char* place) {
    corners_.clear();
    for (const std::int64_t number : numbers) {
      if (is_strip && number == -1) {  // ends one strip and begins the next
        polygons_.add_strip(corners_, place);
        corners_.clear();
      } else {
        corners_.push_back(polygons_.vertex_number(number, place));
      }
    }
    if (is_strip) {
      polygons_.add_strip(corners_, place);
    } else {
      polygons_.add(corners_, place);
    }
  }

  void skip_property(const PlyProperty& property) {
    rows_.skip(property.type, property.count_type ? rows_.whole_number(*property.count_type) : 1);
  }

  void skip_rows(const PlyElement& element) {
    for (std::uint64_t i = 0; i < element.row_count; ++i) {
      for (const PlyProperty& property : element.properties) { skip_property(property); }
      tell_row(i);
    }
    if (element.row_count > 0) {
      reading_.report.refused.push_back(
          fmt::format("{} rows of element {} left out", element.row_count, in_quotes(element.name)));
    }
  }

  void tell_row(std::uint64_t row) {
    if (row % 0x10000 == 0) {
      tell_progress(reading_, 0.8 * static_cast<double>(rows_.place() - reading_.begin()) /
                                  static_cast<double>(reading_.bytes.size()));
    }
  }

  const Reading& reading_;
  const PlyHeader& header_;
  Rows rows_;
  Polygons polygons_;
  bool has_vertices_ = false;
  std::vector<Waiting> waiting_;
  std::vector<std::uint32_t> corners_;
};

}  // namespace

Scene read_ply(const Reading& reading) {
  const PlyHeader header = parse_ply_header(reading);
  return header.format == PlyFormat::text ? PlyBodyReader<TextRows>(reading, header).read()
                                          : PlyBodyReader<ByteRows>(reading, header).read();
}

}  // namespace collided::engine
