#include <fmt/format.h>

#include "client/cli/command.hpp"
#include "client/cli/input/number.hpp"
#include "client/cli/input/option.hpp"
#include "client/cli/input/shape_file.hpp"
#include "client/cli/input/shape_text.hpp"
#include "client/cli/output/answer_output.hpp"
#include "client/cli/verbs/ask_options.hpp"
#include "client/cli/output/readable.hpp"

namespace collided::cli {
namespace {

Record sweep_record(const Answer& answer) {
  const Hit* hit = answer.hits.empty() ? nullptr : &answer.hits.front();
  const Value none = std::monostate{};
  std::string_view word = "free";
  if (answer.verdict == Verdict::hit) word = "contact";
  if (answer.verdict == Verdict::undecided) word = "undecided";
  if (answer.verdict == Verdict::invalid) word = "invalid";
  return {{"answer", word},
          {"object", hit ? Value(std::string_view(hit->object)) : none},
          {"time_low", hit ? Value(hit->time_low) : none},
          {"time_high", hit ? Value(hit->time_high) : none},
          {"point", hit ? MaybeVector(hit->point) : MaybeVector()},
          {"normal", hit ? MaybeVector(hit->normal) : MaybeVector()},
          {"triangle", hit && hit->triangle != kNoTriangle ? Value(std::uint64_t{hit->triangle}) : none},
          {"inside", hit && hit->inside ? Value(true) : none},
          {"stale", hit && hit->stale ? Value(true) : none},
          {"reason", answer.verdict == Verdict::undecided ? Value(name_of(answer.reason)) : none}};
}

std::string contact_line(const Printer& printer, const Hit& hit) {
  const Digits digits = printer.digits();
  const auto fraction = [&](double t) { return digits == Digits::all ? format_number(t) : readable_number(t); };
  std::string line =
      fmt::format("{}  {}  at t in [{}, {}]  point {}  normal {}", printer.paint(Paint::bad, "contact"),
                  printable(hit.object), fraction(hit.time_low), fraction(hit.time_high),
                  readable_point(hit.point, hit.point_error_m, digits), readable_direction(hit.normal, digits));
  if (hit.triangle != kNoTriangle) line += fmt::format("  triangle {}", hit.triangle);
  if (hit.inside) line += "  begins inside";
  if (hit.stale) line += "  stale";
  return line;
}

void print_sweep(Printer& printer, const Answer& answer) {
  if (!printer.human()) {
    printer.record(sweep_record(answer));
    return;
  }
  if (answer.verdict == Verdict::undecided) {
    printer.line(fmt::format("{} {}", printer.paint(Paint::doubt, "undecided:"), explain(answer.reason)));
  }
  if (answer.verdict == Verdict::invalid) printer.line(printer.paint(Paint::bad, "invalid"));
  if (answer.verdict == Verdict::miss) printer.line(printer.paint(Paint::good, "free") + "  nothing is met on the way");
  for (const Hit& hit : answer.hits) printer.line(contact_line(printer, hit));
}

class SweepCommand : public Command {
 public:
  void declare(CLI::App& app) override {
    option(app, "shape", shape_, "sphere R, box X Y Z, capsule R L, cylinder R L, cone R H, ellipsoid X Y Z");
    option(app, "--from X Y Z", from_, "Where it starts");
    option(app, "--to X Y Z", to_, "Where it ends");
    option(app, "--rpy R P Y", rpy_, "Roll, pitch, yaw at the start: 0 0 45deg");
    option(app, "--to-rpy R P Y", to_rpy_, "Roll, pitch, yaw at the end (as at the start)");
    declare_mesh_reading(app, reading_);
    declare_ask_options(app, options_);
  }

  Exit run(Session& session, const Globals& globals) override {
    if (shape_.empty()) throw bad_use("which shape?", "collide sweep sphere 0.1 --from 0 0 1 --to 2 0 1");
    if (from_.empty() || to_.empty()) throw bad_use("a way takes --from X Y Z and --to X Y Z");
    const ShapePart part = shape_of_words(shape_, session.io, reading_);
    print_warning(session.io, angle_warning("--rpy", rpy_));
    print_warning(session.io, angle_warning("--to-rpy", to_rpy_));
    const SweepQuestion motion{parse_pose(from_, rpy_, {}), parse_pose(to_, to_rpy_.empty() ? rpy_ : to_rpy_, {})};
    options_.timeout = timeout_of(globals);
    const Answers answers = take(session.client(globals).sweep({part}, std::span(&motion, 1), options_));
    if (answers.answers.size() != 1) throw Failure(Exit::refused, "the server's answer does not fit the question");
    Printer printer = make_printer(session.io, globals);
    print_sweep(printer, answers.answers.front());
    printer.finish();
    if (globals.verbose || printer.human())
      print_hint(session.io, globals, cost_line(answers, answers.answers.front()));
    const Exit code = exit_of(answers.answers.front());
    if (code == Exit::no) hint_at_unknown_names(session, globals, "--only ", options_.only);
    return code;
  }

 private:
  std::vector<std::string> shape_;
  MeshReading reading_;
  std::string from_;
  std::string to_;
  std::string rpy_;
  std::string to_rpy_;
  AskOptions options_;
};

}  // namespace

std::unique_ptr<Command> make_sweep() { return std::make_unique<SweepCommand>(); }

}  // namespace collided::cli
