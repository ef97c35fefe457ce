#include <filesystem>

#include <fmt/format.h>

#include "client/cli/command.hpp"
#include "client/cli/input/configuration_reader.hpp"
#include "client/cli/input/number.hpp"
#include "client/cli/input/option.hpp"
#include "client/cli/input/robot_configurations.hpp"
#include "client/cli/input/shape_text.hpp"
#include "client/cli/output/answer_output.hpp"
#include "client/cli/output/progress.hpp"
#include "client/cli/output/readable.hpp"
#include "client/cli/verbs/ask_options.hpp"

namespace collided::cli {
namespace {

/// In one request, which is answered on one state.
constexpr std::size_t kMostAtOnce = 100'000;

std::string_view word_of_verdict(Verdict verdict) {
  switch (verdict) {
    case Verdict::miss: return "free";
    case Verdict::hit: return "touching";
    case Verdict::undecided: return "undecided";
    case Verdict::invalid: break;
  }
  return "invalid";
}

class WhatIfCommand : public Command {
 public:
  void declare(CLI::App& app) override {
    option(app, "file FILE", files_, "Rows config,name,x,y,z,qw,qx,qy,qz, or a configuration of JSON a line");
    option(app, "--against GLOB", options_.against, "An object, a scene or a glob (everything else)");
    option(app, "--skip GLOB", options_.skip, "Not objects whose name matches this glob");
    option(app, "--mask", options_.mask, "Layers that count: bits, 0x3 or 0b11");
    app.add_flag("--clearance", options_.with_clearance,
                 "The least clearance of each too; of a contact the greatest depth, instead of the first found");
    option(app, "--nearer", Measure::length, nearer_m_, "With --clearance: not pairs farther apart than this: 5mm");
    app.add_flag("--with-filtered", options_.with_filtered,
                 "Also pairs that masks and groups let pass through each other");
    option(app, "--attach NAME=NAME", attached_, "Moves along in thought: crate=robot/hand; may be given again");
    option(app, "--robot FILE", robot_path_, "A robot (.urdf) of the world, whose links are moved by --joints");
    option(app, "--joints FILE", joints_path_,
           "Positions of its joints (.csv, -): config and the names of joints, rad and m");
    option(app, "--name NAME", place_.scene, "Scene that the robot was loaded as (the stem of its file)");
    option(app, "--at X Y Z", at_, "Where its root link stands: 1,2,0");
    option(app, "--rpy R P Y", rpy_, "Roll, pitch and yaw of its root link: 0,0,90deg");
    app.add_flag("--beyond-limits", place_.beyond_limits, "Take positions beyond the joints' limits");
    option(app, "--deadline", options_.deadline, "Configurations not answered by then are undecided: 5s");
    declare_importance(app, options_.importance);
    declare_instant(app, options_.as_of,
                    "All objects that are not moved at one instant: settled, -2s (before now), 2026-11-22T12:03:10.5Z");
    app.add_flag("--fresh", options_.fresh, "Answer after this connection's own last write");
  }

  Exit run(Session& session, const Globals& globals) override {
    check_source();
    read_options(globals);
    const InputFile file(has_robot() ? joints_path_ : files_[0], session.io.in);
    if (!has_robot()) {
      ConfigurationReader reader(file);
      return ask_all(session, globals, reader);
    }
    const Robot robot = take(Robot::read(robot_path_));
    if (place_.scene.empty()) place_.scene = std::filesystem::path(robot_path_).stem().string();
    place_.base = parse_pose(at_, rpy_, {});
    print_warning(session.io, angle_warning("--rpy", rpy_));
    const RobotObjects objects = take(robot_objects(session.client(globals), robot, place_.scene));
    RobotConfigurations reader(file, robot, objects, place_);
    return ask_all(session, globals, reader);
  }

 private:
  bool has_robot() const { return !robot_path_.empty() || !joints_path_.empty(); }

  void check_source() const {
    if (has_robot() && (robot_path_.empty() || joints_path_.empty()))
      throw bad_use("--robot and --joints go together", "collide what-if --robot arm.urdf --joints plan.csv");
    if (has_robot() && !files_.empty())
      throw bad_use(fmt::format("{} beside --joints: configurations come from one file", printable(files_[0])));
    if (!has_robot() && (!place_.scene.empty() || !at_.empty() || !rpy_.empty() || place_.beyond_limits))
      throw bad_use("--name, --at, --rpy and --beyond-limits go with --robot");
    if (!has_robot() && files_.size() != 1)
      throw bad_use(fmt::format("{} files; one is needed, or - for standard input", files_.size()),
                    "collide what-if plan.csv --against 'cell/*'");
  }

  template <class Reader>
  Exit ask_all(Session& session, const Globals& globals, Reader& reader) {
    Printer printer = make_printer(session.io, globals);
    printer.set_usual_fields({"config", "answer", "a", "b", "clearance"});
    Progress progress(session.io, globals);
    while (read_some(session, reader)) {
      if (ids_.empty()) continue;
      configurations_.objects = reader.objects();
      print(printer, take(session.client(globals).what_if(configurations_, options_)));
      progress.show(counts_.all(), "configurations");
    }
    progress.clear();
    printer.finish();
    print_hint(
        session.io, globals,
        fmt::format("{} configuration{}  free {}  touching {}  undecided {}  refused {}", format_count(counts_.all()),
                    counts_.all() == 1 ? "" : "s", format_count(counts_.free), format_count(counts_.touching),
                    format_count(counts_.undecided), format_count(counts_.refused)));
    if (counts_.refused > 0) return Exit::partly_refused;
    if (counts_.touching > 0) return Exit::no;
    return counts_.undecided > 0 ? Exit::undecided : Exit::yes;
  }

  struct AnswerTally {
    std::size_t free = 0;
    std::size_t touching = 0;
    std::size_t undecided = 0;
    std::size_t refused = 0;
    std::size_t all() const { return free + touching + undecided + refused; }
  };

  void read_options(const Globals& globals) {
    if (nearer_m_ && !options_.with_clearance) throw bad_use("--nearer goes with --clearance");
    options_.nearer_m = nearer_m_.value_or(options_.nearer_m);
    for (const std::string& pair : attached_) {
      const std::size_t sign = pair.find('=');
      if (sign == 0 || sign == std::string::npos || sign + 1 == pair.size())
        throw bad_use(fmt::format("--attach {}: it takes two names, crate=robot/hand", printable(pair)));
      options_.attached.emplace_back(pair.substr(0, sign), pair.substr(sign + 1));
    }
    options_.timeout = timeout_of(globals, std::chrono::seconds(60));
  }

  /// Reads up to one request; false: nothing was left.
  template <class Reader>
  bool read_some(Session& session, Reader& reader) {
    ids_.clear();
    configurations_.poses.clear();
    bool has_any = false;
    while (ids_.size() < kMostAtOnce) {
      auto next = reader.next();
      if (!next) return has_any;
      has_any = true;
      warn_of(session, reader);
      if (!next->refusal.empty()) {
        ++counts_.refused;
        print_error(session.io, next->refusal + "; this configuration was not asked about");
        continue;
      }
      ids_.push_back(std::move(next->id));
      configurations_.poses.insert(configurations_.poses.end(), next->poses.begin(), next->poses.end());
    }
    return has_any;
  }

  static void warn_of(Session&, const ConfigurationReader&) {}
  void warn_of(Session& session, const RobotConfigurations& reader) {
    constexpr std::size_t kMostSaid = 10;
    for (const std::string& warning : reader.warnings()) {
      if (++warned_ <= kMostSaid) print_warning(session.io, warning);
    }
  }

  void print(Printer& printer, const WhatIfAnswers& answers) {
    for (std::size_t i = 0; i < answers.configurations.size(); ++i) {
      const ConfigurationAnswer& answer = answers.configurations[i];
      if (answer.verdict == Verdict::miss) ++counts_.free;
      if (answer.verdict == Verdict::hit) ++counts_.touching;
      if (answer.verdict == Verdict::undecided) ++counts_.undecided;
      if (answer.verdict == Verdict::invalid) ++counts_.refused;
      if (printer.human()) print_row(printer, ids_[i], answer);
      else printer.record(record_of(ids_[i], answer, answers.version));
    }
  }

  /// Without --clearance a pair has only its names.
  bool has_numbers(const ConfigurationAnswer& answer) const { return answer.nearest && options_.with_clearance; }

  void print_row(Printer& printer, const std::string& id, const ConfigurationAnswer& answer) const {
    static constexpr Paint kPaints[] = {Paint::good, Paint::bad, Paint::doubt, Paint::doubt};
    std::string word(word_of_verdict(answer.verdict));
    if (answer.verdict == Verdict::undecided) word += fmt::format(" ({})", name_of(answer.reason));
    std::vector<std::string> cells{
        printable(id), printer.paint(kPaints[static_cast<std::size_t>(answer.verdict)], word),
        answer.nearest ? printable(answer.nearest->a) : "", answer.nearest ? printable(answer.nearest->b) : ""};
    std::vector<std::string> header{"CONFIG", "", "A", "B"};
    if (options_.with_clearance) {
      header.emplace_back("CLEARANCE");
      cells.push_back(has_numbers(answer)
                          ? readable_length(answer.nearest->clearance_m, answer.nearest->error_m, printer.digits())
                          : "");
    }
    printer.row(header, std::move(cells));
  }

  Record record_of(const std::string& id, const ConfigurationAnswer& answer, std::uint64_t version) const {
    const Value none = std::monostate{};
    const auto& pair = answer.nearest;
    const bool known = has_numbers(answer);
    return {{"config", std::string_view(id)},
            {"answer", word_of_verdict(answer.verdict)},
            {"reason", answer.verdict == Verdict::undecided ? Value(name_of(answer.reason)) : none},
            {"a", pair ? Value(std::string_view(pair->a)) : none},
            {"b", pair ? Value(std::string_view(pair->b)) : none},
            {"clearance", known ? Value(pair->clearance_m) : none},
            {"error", known ? Value(pair->error_m) : none},
            {"on_a", known ? MaybeVector(pair->on_a) : MaybeVector()},
            {"on_b", known ? MaybeVector(pair->on_b) : MaybeVector()},
            {"normal", known ? MaybeVector(pair->normal) : MaybeVector()},
            {"stale", pair && pair->stale ? Value(true) : none},
            {"world", version}};
  }

  std::vector<std::string> files_;
  std::vector<std::string> attached_;
  std::string robot_path_;
  std::string joints_path_;
  std::string at_;
  std::string rpy_;
  RobotPlace place_;
  std::size_t warned_ = 0;
  std::optional<double> nearer_m_;
  WhatIfOptions options_;
  WhatIfConfigurations configurations_;
  std::vector<std::string> ids_;  // of those
  AnswerTally counts_;
};

}  // namespace

std::unique_ptr<Command> make_what_if() { return std::make_unique<WhatIfCommand>(); }

}  // namespace collided::cli
