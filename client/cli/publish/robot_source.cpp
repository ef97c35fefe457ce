#include "client/cli/publish/robot_source.hpp"

#include <cmath>
#include <filesystem>
#include <utility>

#include <collided/robot.hpp>
#include <fmt/format.h>

#include "client/cli/input/number.hpp"
#include "client/cli/publish/joint_csv.hpp"
#include "client/cli/session.hpp"

namespace collided::cli {
namespace {

constexpr std::uint64_t kMostSaid = 10;  // refusals, and warnings

class RobotSource : public MotionSource {
 public:
  RobotSource(Io& io, const RobotSourceOptions& options)
      : io_(io), options_(options), robot_(take(Robot::read(options.robot_path))) {
    if (options_.scene.empty()) options_.scene = std::filesystem::path(options_.robot_path).stem().string();
    open();
  }

  void begin(Session& session, const Globals& globals, WorldPublisher& publisher) override {
    read();
    if (!read_ahead_) throw bad_use(fmt::format("{} has no row that can be used", file_->name()));
    Client& client = session.client(globals);
    load_if_missing(client);
    published_ = take(PublishedRobot::claim(client, publisher.of_one_server(), robot_,
                                            {.scene = options_.scene,
                                             .base = options_.base,
                                             .joints = read_ahead_->joints,
                                             .beyond_limits = options_.beyond_limits,
                                             .lost_policy = options_.lost_policy}));
  }

  std::optional<double> next_time() override {
    if (!read_ahead_) read();
    if (!read_ahead_) return std::nullopt;
    row_ = std::move(*read_ahead_);
    read_ahead_.reset();
    if (!row_.time_s) return 0.0;
    if (!first_time_s_) first_time_s_ = row_.time_s;
    return std::max(0.0, *row_.time_s - *first_time_s_);
  }

  std::size_t move(WorldPublisher& publisher) override {
    const Result<std::vector<std::string>> set =
        published_->set_joints(publisher.of_one_server(), row_.joints, is_restarted_);
    is_restarted_ = false;
    moved(set ? Result<void>() : Result<void>(set.error()));
    return published_->object_count();
  }

  bool restart() override {
    if (options_.joints_path == "-") return false;
    open();
    is_restarted_ = true;  // the robot is placed at the start, not moved there through the room
    return true;
  }

  std::uint64_t refused_count() const override { return refused_; }

  void report(Record& record, std::vector<std::string>& lines) const override {
    record.push_back({"objects", std::uint64_t{published_ ? published_->object_count() : 0}});
    lines.push_back(fmt::format("  {} of '{}'{}", counted(published_ ? published_->object_count() : 0, "link"),
                                printable(options_.scene),
                                refused_ > 0 ? fmt::format("; {} lines refused", format_count(refused_)) : ""));
    record.push_back({"chord_error", chord_.metres});
    if (chord_.metres > PublishedRobot::kChordToWarn_m)
      lines.push_back(fmt::format("  links left their arcs by up to {}", format_bound(chord_.metres) + " m"));
  }

 private:
  void open() {
    file_.emplace(options_.joints_path, io_.in);
    csv_.emplace(*file_, robot_);
    csv_->when_waiting([this] { wait_a_moment(); });
    read_ahead_.reset();
    positions_.clear();
    positions_before_.clear();
  }

  void load_if_missing(Client& client) const {
    if (take(client.list({.name = options_.scene + "/*", .limit = 1})).count > 0) return;
    const std::string path = std::filesystem::absolute(options_.robot_path).lexically_normal().string();
    LoadOptions load{.name = options_.scene, .moving = true};
    if (!options_.package.empty()) load.packages = {options_.package};
    take(client.load(path, load));
  }

  void read() {
    JointRow row;
    std::string refusal;
    while (true) {
      const JointCsv::Found found = csv_->next(row, refusal);
      if (found == JointCsv::Found::end) return;
      if (found == JointCsv::Found::row && is_possible(row, refusal)) break;
      if (++refused_ <= kMostSaid) print_error(io_, refusal + "; this row was not sent");
    }
    if (!csv_->has_time() && !options_.paced && options_.joints_path != "-") {
      throw bad_use(fmt::format("{} has no column t", file_->name()),
                    "give --rate HZ to publish its rows at that rate");
    }
    read_ahead_ = std::move(row);
  }

  /// Whether the robot can take this position; warns of suspicious values.
  bool is_possible(const JointRow& row, std::string& refusal) {
    const Result<std::vector<std::string>> set = robot_.set(row.joints, positions_, options_.beyond_limits);
    if (!set) {
      const std::string where = fmt::format("{} line {}: ", file_->name(), csv_->line_number());
      const std::string& hint = set.error().hint;
      refusal = where + set.error().message + (hint.find("degrees") != std::string::npos ? " (" + hint + ")" : "");
      return false;
    }
    for (const std::string& warning : *set) {
      if (++warned_ <= kMostSaid)
        print_warning(io_, fmt::format("{} line {}: {}", file_->name(), csv_->line_number(), warning));
    }
    warn_of_chord();
    return true;
  }

  /// Between two rows a link is swept in a straight line. A worse row than before is reported once it is twice as bad.
  void warn_of_chord() {
    const std::vector<double> before = std::exchange(positions_before_, positions_);
    if (before.size() != positions_.size()) return;
    const Robot::ChordError chord = robot_.chord_error(before, positions_);
    if (!(chord.metres > chord_.metres)) return;
    chord_ = chord;
    if (!(chord.metres > PublishedRobot::kChordToWarn_m && chord.metres > 2 * chord_warned_m_)) return;
    chord_warned_m_ = chord.metres;
    const auto more = static_cast<std::uint64_t>(std::ceil(std::sqrt(chord.metres / PublishedRobot::kChordToWarn_m)));
    print_warning(
        io_, fmt::format("{} line {}: link '{}' leaves its arc by up to {} m, so contacts may be false or missing; "
                         "{} times as many rows: 1 mm",
                         file_->name(), csv_->line_number(), printable(robot_.links()[chord.link]),
                         format_bound(chord.metres), more));
  }

  Io& io_;
  RobotSourceOptions options_;
  Robot robot_;
  std::optional<InputFile> file_;
  std::optional<JointCsv> csv_;
  std::optional<JointRow> read_ahead_;
  JointRow row_;
  std::vector<double> positions_;         // of the last row that was read
  std::vector<double> positions_before_;  // of the row before; empty: there is none
  Robot::ChordError chord_;               // the worst so far
  double chord_warned_m_ = 0;
  std::optional<PublishedRobot> published_;
  std::optional<double> first_time_s_;
  std::uint64_t refused_ = 0;
  std::uint64_t warned_ = 0;
  bool is_restarted_ = false;
};

}  // namespace

std::unique_ptr<MotionSource> make_robot_source(Io& io, const RobotSourceOptions& options) {
  return std::make_unique<RobotSource>(io, options);
}

}  // namespace collided::cli
