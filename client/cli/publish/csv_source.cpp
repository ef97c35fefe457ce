#include "client/cli/publish/csv_source.hpp"

#include <unordered_map>

#include <fmt/format.h>

#include "client/cli/input/number.hpp"
#include "client/cli/publish/pose_csv.hpp"
#include "client/cli/session.hpp"

namespace collided::cli {
namespace {

constexpr std::uint64_t kMostRefusalsPrinted = 10;

class CsvSource : public MotionSource {
 public:
  CsvSource(Io& io, const CsvSourceOptions& options) : io_(io), options_(options) { open(); }

  void begin(Session&, const Globals&, WorldPublisher&) override {}

  std::optional<double> next_time() override {
    frame_.clear();
    place_in_frame_.clear();
    if (!read_ahead_) read();
    if (!read_ahead_) return std::nullopt;
    const std::optional<double> time_s = read_ahead_->time_s;
    // A frame is the rows with one time. Without times, it is one row for each object in a file, and the available rows
    // in a pipe.
    while (read_ahead_ && belongs_to_frame(time_s)) {
      put_into_frame(std::move(*read_ahead_));
      read_ahead_.reset();
      if (options_.path == "-" && !csv_->ready()) break;
      read();
    }
    if (!time_s) return 0.0;
    if (!first_time_s_) first_time_s_ = time_s;
    return std::max(0.0, *time_s - *first_time_s_);
  }

  std::size_t move(WorldPublisher& publisher) override {
    const std::size_t known = objects_.size();
    for (const PoseRow& row : frame_) {
      auto found = objects_.find(row.name);
      if (found == objects_.end())
        found = objects_.emplace(row.name, take(publisher.add(definition(row.name, row.pose)))).first;
      moved(publisher.move(found->second, row.pose));
    }
    if (options_.objects.solid && objects_.size() > known) take(publisher.wait_applied(kPatience));
    has_own_instants_ = has_own_instants_ || frame_.size() < objects_.size();
    return frame_.size();
  }

  bool has_own_instants() const override { return has_own_instants_; }

  bool restart() override {
    if (options_.path == "-") return false;
    open();
    return true;
  }

  std::uint64_t refused_count() const override { return refused_; }

  void report(Record& record, std::vector<std::string>& lines) const override {
    record.push_back({"objects", std::uint64_t{objects_.size()}});
    lines.push_back(fmt::format("  {}{}", counted(objects_.size(), "object"),
                                refused_ > 0 ? fmt::format("; {} lines refused", format_count(refused_)) : ""));
  }

 private:
  void open() {
    file_.emplace(options_.path, io_.in);
    csv_.emplace(*file_);
    csv_->when_waiting([this] { wait_a_moment(); });
    read_ahead_.reset();
  }

  bool belongs_to_frame(const std::optional<double>& time_s) const {
    if (time_s) return read_ahead_->time_s == time_s;
    return !place_in_frame_.contains(read_ahead_->name);
  }

  /// Adds a row to the frame, in order; a later row of the same object replaces an earlier one.
  void put_into_frame(PoseRow row) {
    const auto [place, is_new] = place_in_frame_.emplace(row.name, frame_.size());
    if (is_new) frame_.push_back(std::move(row));
    else frame_[place->second].pose = row.pose;
  }

  void read() {
    PoseRow row;
    std::string refusal;
    while (true) {
      const PoseCsv::Found found = csv_->next(row, refusal);
      if (found == PoseCsv::Found::end) return;
      if (found == PoseCsv::Found::row) break;
      if (++refused_ <= kMostRefusalsPrinted) print_error(io_, refusal + "; this pose was not sent");
    }
    if (!csv_->has_time() && !options_.paced && options_.path != "-") {
      throw bad_use(fmt::format("{} has no column t", file_->name()),
                    "give --rate HZ to publish its frames at that rate");
    }
    read_ahead_ = std::move(row);
  }

  ObjectOptions definition(const std::string& name, const Pose& pose) const {
    ObjectOptions object;
    object.name = name;
    object.shape = {options_.shape};
    object.pose = pose;
    object.layers = options_.objects.layers;
    object.mask = options_.objects.mask;
    object.lost_policy = options_.objects.lost_policy;
    object.solid = options_.objects.solid;
    object.solid_by_winding = options_.objects.solid_by_winding;
    return object;
  }

  Io& io_;
  CsvSourceOptions options_;
  std::optional<InputFile> file_;
  std::optional<PoseCsv> csv_;
  std::optional<PoseRow> read_ahead_;
  std::vector<PoseRow> frame_;
  std::unordered_map<std::string, std::size_t> place_in_frame_;
  std::unordered_map<std::string, Publisher::Object> objects_;
  std::optional<double> first_time_s_;
  std::uint64_t refused_ = 0;
  bool has_own_instants_ = false;
};

}  // namespace

std::unique_ptr<MotionSource> make_csv_source(Io& io, const CsvSourceOptions& options) {
  return std::make_unique<CsvSource>(io, options);
}

}  // namespace collided::cli
