#include "client/cli/verbs/clearance_output.hpp"

#include "client/cli/output/readable.hpp"

namespace collided::cli {
namespace {

Value of_triangle(std::uint32_t triangle) {
  if (triangle == kNoTriangle) return std::monostate{};
  return std::uint64_t{triangle};
}

std::string_view proof_of(const ClearancePair& pair) { return pair.certificate ? "proved" : "none"; }

std::string_view inner_of(Containment contained) {
  if (contained == Containment::a_in_b) return "a";
  return contained == Containment::b_in_a ? "b" : "";
}

Record record_of(const ClearancePair& pair, std::uint64_t version, bool with_proof) {
  const Value none = std::monostate{};
  return {{"a", std::string_view(pair.a)},
          {"b", std::string_view(pair.b)},
          {"answer", state_of(pair)},
          {"clearance", pair.clearance_m},
          {"error", pair.error_m},
          {"contained", inner_of(pair.contained)},
          {"on_a", MaybeVector(pair.on_a)},
          {"on_b", MaybeVector(pair.on_b)},
          {"point_error", pair.point_error_m},
          {"normal", MaybeVector(pair.normal)},
          {"a_triangle", of_triangle(pair.a_triangle)},
          {"b_triangle", of_triangle(pair.b_triangle)},
          {"certificate", with_proof ? Value(proof_of(pair)) : none},
          {"stale", pair.stale ? Value(true) : none},
          {"world", version}};
}

Paint paint_of(const ClearancePair& pair) {
  if (pair.verdict == Verdict::undecided) return Paint::doubt;
  return pair.verdict == Verdict::hit ? Paint::bad : Paint::good;
}

}  // namespace

std::string_view state_of(const ClearancePair& pair) {
  if (pair.verdict == Verdict::undecided) return "undecided";
  if (pair.contained != Containment::none) return "inside";
  return pair.verdict == Verdict::hit ? "touching" : "apart";
}

void print_clearance(Printer& printer, const ClearanceAnswer& answer, bool with_proof) {
  printer.set_usual_fields({"a", "b", "answer", "clearance", "error"});
  for (const ClearancePair& pair : answer.pairs) {
    if (!printer.human()) {
      printer.record(record_of(pair, answer.version, with_proof));
      continue;
    }
    std::vector<std::string> header{"A", "B", "", "CLEARANCE", "ON A", "ON B"};
    std::vector<std::string> cells{printable(pair.a),
                                   printable(pair.b),
                                   printer.paint(paint_of(pair), state_of(pair)),
                                   readable_length(pair.clearance_m, pair.error_m, printer.digits()),
                                   readable_point(pair.on_a, pair.point_error_m, printer.digits()),
                                   readable_point(pair.on_b, pair.point_error_m, printer.digits())};
    if (with_proof) {
      header.emplace_back("PROOF");
      cells.emplace_back(proof_of(pair));
    }
    printer.row(header, std::move(cells));
  }
}

}  // namespace collided::cli
