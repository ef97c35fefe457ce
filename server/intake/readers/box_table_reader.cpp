#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <optional>

#include "idl/unit_quaternion.hpp"
#include "server/geometry/tolerance.hpp"
#include "server/intake/limits.hpp"
#include "server/intake/readers/reading.hpp"

namespace collided::engine {
namespace {

using Cells = std::vector<std::string_view>;

Cells cells_of(std::string_view line) {
  Cells cells;
  for (std::size_t begin = 0;;) {
    const std::size_t comma = line.find(',', begin);
    std::string_view cell = line.substr(begin, comma == std::string_view::npos ? comma : comma - begin);
    while (!cell.empty() && (cell.front() == ' ' || cell.front() == '\t')) cell.remove_prefix(1);
    while (!cell.empty() && (cell.back() == ' ' || cell.back() == '\t' || cell.back() == '\r')) cell.remove_suffix(1);
    if (cell.size() >= 2 && cell.front() == '"' && cell.back() == '"') cell = cell.substr(1, cell.size() - 2);
    cells.push_back(cell);
    if (comma == std::string_view::npos) return cells;
    begin = comma + 1;
  }
}

/// The indexes of columns that belong together, from the heading.
template <std::size_t kCount>
using Columns = std::array<std::size_t, kCount>;

/// Reads a table of boxes, one per line, whose heading names the columns: the centre x,y,z and the full sizes sx,sy,sz,
/// and perhaps a rotation qw,qx,qy,qz; or the corners min_x,min_y,min_z,max_x,max_y,max_z. The box's name is in a
/// column name, id or object.
class BoxTableReader {
 public:
  explicit BoxTableReader(const Reading& reading) : reading_(reading) {}

  Scene read() {
    std::string_view line;
    if (!next_line(line)) refuse(reading_, "no heading");
    read_heading(cells_of(line));
    while (next_line(line)) add_box(cells_of(line));
    if (scene_.objects.empty()) refuse(reading_, "no boxes");
    return std::move(scene_);
  }

 private:
  /// The next line that is not empty and does not begin with '#'; false at the end.
  bool next_line(std::string_view& line) {
    while (at_ < reading_.bytes.size()) {
      const std::string_view rest(reading_.begin() + at_, reading_.bytes.size() - at_);
      line = rest.substr(0, rest.find('\n'));
      line_begin_ = reading_.begin() + at_;
      at_ += line.size() + 1;
      if (line.find_first_not_of(" \t\r") != std::string_view::npos && line[0] != '#') return true;
    }
    return false;
  }

  [[noreturn]] void complain(const std::string& what) const { refuse_line(reading_, line_begin_, what); }

  std::optional<std::size_t> column(std::string_view name) const {
    const auto found = std::find(heading_.begin(), heading_.end(), name);
    if (found == heading_.end()) return std::nullopt;
    return static_cast<std::size_t>(found - heading_.begin());
  }

  /// The first of several sets of column names that is completely in the heading.
  template <std::size_t kCount>
  std::optional<Columns<kCount>> columns(std::initializer_list<std::array<const char*, kCount>> motions) const {
    for (const auto& displacement : motions) {
      Columns<kCount> numbers{};
      std::size_t found = 0;
      for (; found < kCount; ++found) {
        const std::optional<std::size_t> number = column(displacement[found]);
        if (!number) break;
        numbers[found] = *number;
      }
      if (found == kCount) return numbers;
    }
    return std::nullopt;
  }

  void read_heading(const Cells& cells) {
    heading_ = cells;
    const auto corners = columns<6>(
        {{"min_x", "min_y", "min_z", "max_x", "max_y", "max_z"}, {"xmin", "ymin", "zmin", "xmax", "ymax", "zmax"}});
    if (corners) {
      std::copy_n(corners->begin(), 3, low_.begin());
      std::copy_n(corners->begin() + 3, 3, high_.begin());
      has_corners_ = true;
    } else {
      const auto center = columns<3>({{"x", "y", "z"}, {"cx", "cy", "cz"}});
      const auto size = columns<3>({{"sx", "sy", "sz"}, {"size_x", "size_y", "size_z"}, {"dx", "dy", "dz"}});
      if (!center || !size) complain("the heading has neither x,y,z,sx,sy,sz nor min_x,min_y,min_z,max_x,max_y,max_z");
      low_ = *center;
      high_ = *size;
      turn_ = columns<4>({{"qw", "qx", "qy", "qz"}});
    }
    for (const char* name : {"name", "id", "object"}) {
      if (!name_) name_ = column(name);
    }
    type_ = column("type");
  }

  double number(const Cells& cells, std::size_t column) const {
    const std::string_view cell = cells[column];
    double value = 0;
    const char* const begin = cell.data() + (cell.starts_with('+') ? 1 : 0);
    const auto [end, error] = std::from_chars(begin, cell.data() + cell.size(), value);
    if (error != std::errc{} || end != cell.data() + cell.size() || !std::isfinite(value)) {
      complain(fmt::format("{} in column {} is no finite number", in_quotes(cell), in_quotes(heading_[column])));
    }
    return value;
  }

  Vec3 vector(const Cells& cells, const Columns<3>& columns) const {
    return {number(cells, columns[0]), number(cells, columns[1]), number(cells, columns[2])};
  }

  void add_box(const Cells& cells) {
    if (cells.size() != heading_.size())
      complain(fmt::format("{} columns, the heading has {}", cells.size(), heading_.size()));
    if (type_ && cells[*type_] != "box") complain(fmt::format("type {}; only box is read", in_quotes(cells[*type_])));
    if (scene_.objects.size() == kMaxCloudPoints) complain(fmt::format("more than {} boxes", kMaxCloudPoints));
    SceneObject object;
    object.name = name_ ? std::string(cells[*name_]) : fmt::format("box_{}", scene_.objects.size());
    Vec3 size;
    if (has_corners_) {
      const Vec3 low = vector(cells, low_);
      const Vec3 high = vector(cells, high_);
      size = high - low;
      object.pose.position = low + size / 2;
    } else {
      object.pose.position = vector(cells, low_);
      size = vector(cells, high_);
    }
    if (!((size.array() >= 0).all() && size.allFinite())) {
      complain(fmt::format("a size of {} {} {}, allowed are finite sizes of 0 and more", size[0], size[1], size[2]));
    }
    if (turn_) object.pose.rotation = rotation(cells);
    object.shape.primitives.push_back(Box{.center = Vec3::Zero(), .half_m = size / 2});
    scene_.objects.push_back(std::move(object));
  }

  Quat rotation(const Cells& cells) const {
    const Quat q(number(cells, (*turn_)[0]), number(cells, (*turn_)[1]), number(cells, (*turn_)[2]),
                 number(cells, (*turn_)[3]));
    const double norm = q.norm();
    if (!wire_contract::is_unit_quaternion(q))
      complain(fmt::format("quaternion norm {}, allowed 1 +- {}", norm, kUnitNormSlack));
    return std::abs(q.squaredNorm() - 1) > kNormalizedSlack ? Quat(q.coeffs() / norm) : q;
  }

  const Reading& reading_;
  std::size_t at_ = 0;
  const char* line_begin_ = nullptr;
  Cells heading_;
  Columns<3> low_{};   // the low corner, or the centre
  Columns<3> high_{};  // the high corner, or the whole size
  bool has_corners_ = false;
  std::optional<Columns<4>> turn_;
  std::optional<std::size_t> name_;
  std::optional<std::size_t> type_;
  Scene scene_;
};

}  // namespace

Scene read_box_table(const Reading& reading) { return BoxTableReader(reading).read(); }

}  // namespace collided::engine
