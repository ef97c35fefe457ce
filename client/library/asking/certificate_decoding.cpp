#include "client/library/asking/certificate_decoding.hpp"

#include <algorithm>
#include <array>
#include <limits>
#include <nlohmann/json.hpp>

#include "collided/geometry.hpp"

namespace collided::client {

namespace {

using Numbers = CertifiedPart::Numbers;

CertifiedPart part_of(const nlohmann::json& value) {
  static constexpr std::array<const char*, 6> kBeside{"nothing", "ball", "box", "ellipsoid", "disc", "half_space"};
  CertifiedPart part;
  const std::string summand = value.at("beside");
  const auto* const found = std::find(kBeside.begin(), kBeside.end(), summand);
  // An unknown kind must not be taken for a smaller set, which would prove too much.
  if (found == kBeside.end()) {
    throw nlohmann::json::other_error::create(501, "unknown kind of part: " + summand, &value);
  }
  part.summand = static_cast<CertifiedPart::Summand>(found - kBeside.begin());
  part.triangle = value.value("triangle", kNoTriangle);
  part.points = value.at("points").get<std::vector<Numbers>>();
  part.radius_m = value.value("radius_m", 0.0);
  part.tapers = value.value("tapers", false);
  if (value.contains("axes")) {
    part.axes = value.at("axes").get<std::array<Numbers, 3>>();
    part.half_m = value.at("half_m").get<Numbers>();
  }
  return part;
}

Certificate::Step step_of(const nlohmann::json& value) {
  using Kind = Certificate::Step::Kind;
  if (value.contains("split_a")) { return {.kind = Kind::split_a, .at = value.at("split_a")}; }
  if (value.contains("split_b")) { return {.kind = Kind::split_b, .at = value.at("split_b")}; }
  return {.kind = Kind::plane, .normal = value.at("normal").get<Numbers>(), .point = value.at("point").get<Numbers>()};
}

}  // namespace

double number_or_inf(const nlohmann::json& value) {
  return value.is_string() ? std::numeric_limits<double>::infinity() : value.get<double>();
}

Certificate certificate_of(const nlohmann::json& value) {
  Certificate certificate;
  certificate.touches = value.at("touches");
  for (const nlohmann::json& part : value.at("a")) { certificate.a.push_back(part_of(part)); }
  for (const nlohmann::json& part : value.at("b")) { certificate.b.push_back(part_of(part)); }
  if (certificate.touches) {
    certificate.point = value.at("point").get<std::array<Certificate::Sum, 3>>();
    certificate.divisor = value.at("divisor").get<Certificate::Sum>();
    certificate.mix_a = value.at("mix_a").get<Certificate::Mix>();
    certificate.mix_b = value.at("mix_b").get<Certificate::Mix>();
    return certificate;
  }
  for (const nlohmann::json& step : value.at("steps")) { certificate.steps.push_back(step_of(step)); }
  return certificate;
}

}  // namespace collided::client
