#include "server/service/commands/certificate_encoding.hpp"

#include <cmath>
#include <nlohmann/json.hpp>

#include "server/service/commands/object_description.hpp"

namespace collided::engine::service {

using nlohmann::json;

namespace {

json described(const ProofPart& proof_part) {
  static constexpr const char* kBeside[] = {"nothing", "ball", "box", "ellipsoid", "disc", "half_space"};
  using Summand = PartNumbers::Summand;
  const PartNumbers set = numbers_of(proof_part.part);
  json part{{"beside", kBeside[static_cast<std::size_t>(set.summand)]}, {"points", json::array()}};
  if (proof_part.triangle != kNoTriangle) part["triangle"] = proof_part.triangle;
  for (const Vec3& point : set.points) part["points"].push_back(numbers(point));
  if (set.summand == Summand::box || set.summand == Summand::ellipsoid || set.summand == Summand::half_space) {
    part["axes"] = {numbers(set.axes.col(0)), numbers(set.axes.col(1)), numbers(set.axes.col(2))};
    part["half_m"] = numbers(set.half_m);
  }
  if (set.summand == Summand::ball || set.summand == Summand::disc) part["radius_m"] = set.radius_m;
  if (set.summand == Summand::disc) part["tapers"] = set.tapers;
  return part;
}

json described(const ProofStep& step) {
  switch (step.kind) {
    case ProofStep::Kind::plane: return {{"normal", numbers(step.normal)}, {"point", numbers(step.point)}};
    case ProofStep::Kind::split_a: return {{"split_a", step.at}};
    case ProofStep::Kind::split_b: break;
  }
  return {{"split_b", step.at}};
}

}  // namespace

json number_or_inf(double value) { return std::isfinite(value) ? json(value) : json("inf"); }

json certificate_json(const Proof& proof) {
  json certificate{{"touches", proof.touches}, {"a", json::array()}, {"b", json::array()}};
  for (const ProofPart& part : proof.a) certificate["a"].push_back(described(part));
  for (const ProofPart& part : proof.b) certificate["b"].push_back(described(part));
  if (proof.touches) {
    certificate["point"] = {proof.point[0], proof.point[1], proof.point[2]};
    certificate["divisor"] = proof.divisor;
    certificate["mix_a"] = proof.mix_a;
    certificate["mix_b"] = proof.mix_b;
    return certificate;
  }
  certificate["steps"] = json::array();
  for (const ProofStep& step : proof.steps) certificate["steps"].push_back(described(step));
  return certificate;
}

}  // namespace collided::engine::service
