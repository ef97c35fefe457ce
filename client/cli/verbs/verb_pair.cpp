#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "client/cli/command.hpp"
#include "client/cli/input/number.hpp"
#include "client/cli/input/option.hpp"
#include "client/cli/output/answer_output.hpp"
#include "client/cli/server_command.hpp"
#include "client/cli/verbs/ask_options.hpp"
#include "client/cli/verbs/asked_world.hpp"
#include "client/cli/output/readable.hpp"

namespace collided::cli {
namespace {

nlohmann::json numbers(const Vec3& v) { return {v.x() + 0.0, v.y() + 0.0, v.z() + 0.0}; }

Value triangle_value(std::uint32_t triangle) {
  if (triangle == kNoTriangle) return std::monostate{};
  return std::uint64_t{triangle};
}

std::string_view word_of(Verdict verdict) {
  if (verdict == Verdict::hit) return "touching";
  return verdict == Verdict::miss ? "apart" : "undecided";
}

std::string_view word_of(Containment contained) {
  if (contained == Containment::a_in_b) return "a";
  return contained == Containment::b_in_a ? "b" : "";
}

RawJson manifold_json(const PairAnswer& pair) {
  nlohmann::json points = nlohmann::json::array();
  for (const ManifoldPoint& p : pair.manifold)
    points.push_back({{"point", numbers(p.point)}, {"depth", p.depth_m}, {"error", p.error_m}});
  return {points.dump()};
}

std::string deep_text(const PairAnswer& pair, Digits digits) {
  return readable_length(pair.depth_m, pair.depth_error_m, digits) + " deep";
}

Record pair_record(const ShardedPairAnswer& pair, const Value& proof) {
  const Value none = std::monostate{};
  const bool touching = pair.verdict == Verdict::hit;
  const bool apart = pair.verdict == Verdict::miss;
  const bool known = touching || apart;
  return {{"answer", word_of(pair.verdict)},
          {"reason", known ? none : Value(name_of(pair.reason))},
          {"distance", apart ? Value(pair.distance_m) : none},
          {"depth", touching || pair.is_in_solid ? Value(pair.depth_m) : none},
          {"depth_error", pair.is_in_solid ? Value(pair.depth_error_m) : none},
          {"error", known ? Value(pair.error_m) : none},
          {"farther_than", pair.farther_than_m > 0 ? Value(pair.farther_than_m) : none},
          {"normal", known ? MaybeVector(pair.normal) : MaybeVector()},
          {"point", touching ? MaybeVector(pair.point) : MaybeVector()},
          {"on_a", apart ? MaybeVector(pair.on_a) : MaybeVector()},
          {"on_b", apart ? MaybeVector(pair.on_b) : MaybeVector()},
          {"a_triangle", touching ? triangle_value(pair.a_triangle) : none},
          {"b_triangle", touching ? triangle_value(pair.b_triangle) : none},
          {"contained", apart ? Value(word_of(pair.contained)) : none},
          {"manifold", touching ? Value(manifold_json(pair)) : none},
          {"certificate", proof},
          {"stale", pair.stale ? Value(true) : none},
          {"world", pair.version}};
}

void print_text(Printer& printer, const ShardedPairAnswer& pair) {
  const Digits digits = printer.digits();
  if (pair.farther_than_m > 0) {
    printer.line(fmt::format("{}: no shard holds both, so they are farther apart than {}",
                             printer.paint(Paint::doubt, "undecided"),
                             readable_length(pair.farther_than_m, 0, digits)));
  } else if (pair.verdict == Verdict::undecided) {
    printer.line(fmt::format("{}: {}", printer.paint(Paint::doubt, "undecided"), explain(pair.reason)));
  } else if (pair.verdict == Verdict::miss) {
    printer.line(fmt::format("{}  {}  nearest {} | {}", printer.paint(Paint::good, "apart"),
                             readable_length(pair.distance_m, pair.error_m, digits),
                             readable_point(pair.on_a, pair.error_m, digits),
                             readable_point(pair.on_b, pair.error_m, digits)));
    if (pair.contained != Containment::none)
      printer.line(fmt::format("  {} lies within the other{}", word_of(pair.contained),
                               pair.is_in_solid ? ", a solid, " + deep_text(pair, digits) : ""));
  } else {
    const Vec3 displacement = pair.depth_m * pair.normal;
    printer.line(fmt::format("{}  depth {}  at {}  apart by {}", printer.paint(Paint::bad, "touching"),
                             readable_length(pair.depth_m, pair.error_m, digits),
                             readable_point(pair.point, pair.error_m, digits),
                             readable_point(displacement, pair.error_m, digits)));
    for (const ManifoldPoint& p : pair.manifold) {
      printer.line(fmt::format("  bears at {}  {} deep", readable_point(p.point, p.error_m, digits),
                               readable_length(p.depth_m, p.error_m, digits)));
    }
  }
  if (pair.stale && pair.verdict != Verdict::undecided)
    printer.line("  stale: one of them is where it was heard of last, and moved then");
}

std::string words_of(const SecondOpinion& opinion) {
  if (!opinion.touches) return opinion.why;
  if (*opinion.touches) return "touching";
  return opinion.distance_m ? "apart " + readable_length(*opinion.distance_m, 0, Digits::rounded)
                            : "apart (" + opinion.why + ")";
}

/// The other library's answer, with the server's own next to it if they differ.
std::string opinion_line(const Printer& printer, const PairAnswer& pair) {
  const SecondOpinion& opinion = *pair.opinion;
  const bool differs = opinion.verdict == OpinionVerdict::differ;
  const Paint paint = differs ? Paint::bad : opinion.verdict == OpinionVerdict::agree ? Paint::good : Paint::doubt;
  std::string line = fmt::format("  FCL: {}  {}", printer.paint(paint, std::string(name_of(opinion.verdict))),
                                 printable(words_of(opinion)));
  if (differs && pair.verdict == Verdict::hit)
    line += fmt::format(", ours: touching, depth {}", readable_length(pair.depth_m, pair.error_m, printer.digits()));
  if (differs && pair.verdict == Verdict::miss)
    line += fmt::format(", ours: apart {}", readable_length(pair.distance_m, pair.error_m, printer.digits()));
  return line;
}

void append_opinion(const SecondOpinion& opinion, Record& record) {
  const Value none = std::monostate{};
  record.push_back({"opinion", name_of(opinion.verdict)});
  record.push_back(
      {"opinion_answer", opinion.touches ? Value(std::string_view(*opinion.touches ? "touching" : "apart")) : none});
  record.push_back({"opinion_distance", opinion.distance_m ? Value(*opinion.distance_m) : none});
  record.push_back({"opinion_why", opinion.why.empty() ? none : Value(std::string_view(opinion.why))});
}

class PairCommand : public Command {
 public:
  void declare(CLI::App& app) override {
    option(app, "names OBJECT", names_, "The two objects");
    app.add_flag("--triangles", options_.triangles,
                 "Every pair of triangles that meet, with the segment that they share");
    option(app, "--most", most_, "At most so many pairs of triangles (10000, up to 100000)");
    declare_instant(
        app, options_.as_of,
        "Both at one instant: settled, -2s (before now), 2026-11-22T12:03:10.5Z (latest: each at its newest pose)");
    option(app, "--deadline", options_.deadline, "An answer that takes longer is undecided: 100ms");
    option(app, "--opinion WHOSE", options_.opinion,
           "Ask another library too: fcl, run by the server in a process of its own");
    app.add_flag("--certificate", options_.certificate,
                 "Ask for a proof and check it here, by exact arithmetic of its own");
  }

  bool takes_shards() const override { return true; }

  Exit run(Session& session, const Globals& globals) override {
    if (names_.size() != 2)
      throw bad_use(fmt::format("{} names; two objects are needed", names_.size()), "collide pair crate shelf");
    if (!options_.opinion.empty() && options_.opinion != "fcl")
      throw bad_use(fmt::format("--opinion {}: allowed is fcl", printable(options_.opinion)));
    options_.most_triangle_pairs = static_cast<std::uint32_t>(std::min<std::uint64_t>(most_, 1 << 30));
    options_.timeout = timeout_of(globals, std::chrono::seconds(30));
    const ShardedPairAnswer pair = ask(session, globals, options_);
    const bool fits = pair.certificate && pair.certificate->touches == (pair.verdict == Verdict::hit);
    const bool proved = fits && proves(*pair.certificate);
    if (pair.certificate && !proved) {
      throw Failure(Exit::undecided, "the server's certificate does not prove its answer",
                    "collide pair without --certificate shows the answer");
    }
    Printer printer = make_printer(session.io, globals);
    if (options_.triangles) print_triangles(printer, pair);
    else
      print_answer(
          printer, pair,
          options_.certificate ? Value(std::string_view(proved ? "proved" : "none")) : Value(std::monostate{}));
    printer.finish();
    if (pair.cut)
      print_hint(session.io, globals,
                 fmt::format("cut: {} of {} pairs of triangles; --most tells more, up to 100 000",
                             format_count(pair.triangle_pairs.size()), format_count(pair.triangle_pair_count)));
    if (options_.certificate) print_hint(session.io, globals, proof_line(pair));
    if (pair.verdict == Verdict::undecided) return Exit::undecided;
    return pair.verdict == Verdict::hit ? Exit::yes : Exit::no;
  }

 private:
  ShardedPairAnswer ask(Session& session, const Globals& globals, const PairOptions& options) const {
    const Result<ShardedPairAnswer> pair = AskedWorld(session, globals).pair(names_[0], names_[1], options);
    if (pair || pair.error().code != ErrorCode::refused || !globals.shards.empty()) return take(pair);
    for (const std::string& name : names_) {
      if (const std::optional<Failure> unknown = unknown_object(session, globals, name)) throw Failure(*unknown);
    }
    throw as_failure(pair.error());
  }

  static void print_answer(Printer& printer, const ShardedPairAnswer& pair, const Value& proof) {
    if (printer.human()) {
      print_text(printer, pair);
      if (pair.opinion) printer.line(opinion_line(printer, pair));
      return;
    }
    Record record = pair_record(pair, proof);
    if (pair.opinion) append_opinion(*pair.opinion, record);
    printer.record(record);
  }

  static void print_triangles(Printer& printer, const PairAnswer& pair) {
    for (const TrianglePair& t : pair.triangle_pairs) {
      if (printer.human()) {
        printer.row({"A", "B", "FROM", "TO", "±"},
                    {std::to_string(t.a_triangle), std::to_string(t.b_triangle),
                     readable_point(t.from, t.error_m, printer.digits()),
                     readable_point(t.to, t.error_m, printer.digits()), format_bound(t.error_m)});
        continue;
      }
      printer.record({{"a_triangle", std::uint64_t{t.a_triangle}},
                      {"b_triangle", std::uint64_t{t.b_triangle}},
                      {"from", MaybeVector(t.from)},
                      {"to", MaybeVector(t.to)},
                      {"error", t.error_m}});
    }
  }

  static std::string proof_line(const PairAnswer& pair) {
    if (!pair.certificate) return "no certificate: " + pair.no_certificate;
    const Certificate& c = *pair.certificate;
    if (!c.touches)
      return fmt::format("proved here: {} plane{} between {} and {} parts", plane_count(c),
                         plane_count(c) == 1 ? "" : "s", c.a.size(), c.b.size());
    const auto part = [](const CertifiedPart& p) {
      return p.triangle == kNoTriangle ? std::string("a solid part") : fmt::format("triangle {}", p.triangle);
    };
    return fmt::format("proved here: a point common to {} of the first and {} of the second", part(c.a[0]),
                       part(c.b[0]));
  }

  static std::ptrdiff_t plane_count(const Certificate& c) {
    return std::count_if(c.steps.begin(), c.steps.end(),
                         [](const Certificate::Step& step) { return step.kind == Certificate::Step::Kind::plane; });
  }

  std::vector<std::string> names_;
  PairOptions options_;
  std::uint64_t most_ = 10'000;
};

}  // namespace

std::unique_ptr<Command> make_pair_verb() { return std::make_unique<PairCommand>(); }

}  // namespace collided::cli
