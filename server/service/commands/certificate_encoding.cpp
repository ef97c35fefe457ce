#include "server/service/commands/certificate_encoding.hpp"

#include <algorithm>
#include <iterator>

namespace collided::engine::service {
namespace {

CertifiedPart::Numbers certified(const Vec3& v) { return {v.x() + 0.0, v.y() + 0.0, v.z() + 0.0}; }

CertifiedPart certified(const ProofPart& proof_part) {
  const PartNumbers set = numbers_of(proof_part.part);
  CertifiedPart part{.summand = static_cast<CertifiedPart::Summand>(set.summand),
                     .triangle = proof_part.triangle,
                     .radius_m = set.radius_m,
                     .tapers = set.tapers,
                     .axes = {certified(set.axes.col(0)), certified(set.axes.col(1)), certified(set.axes.col(2))},
                     .half_m = certified(set.half_m)};
  std::ranges::transform(set.points, std::back_inserter(part.points), [](const Vec3& v) { return certified(v); });
  return part;
}

}  // namespace

Certificate certificate_of(const Proof& proof) {
  Certificate certificate{.touches = proof.touches};
  std::ranges::transform(proof.a, std::back_inserter(certificate.a),
                         [](const ProofPart& part) { return certified(part); });
  std::ranges::transform(proof.b, std::back_inserter(certificate.b),
                         [](const ProofPart& part) { return certified(part); });
  if (proof.touches) {
    std::ranges::copy(proof.point, certificate.point.begin());
    certificate.divisor = proof.divisor;
    certificate.mix_a = proof.mix_a;
    certificate.mix_b = proof.mix_b;
  }
  for (const ProofStep& step : proof.steps)
    certificate.steps.push_back({.kind = static_cast<Certificate::Step::Kind>(step.kind),
                                 .normal = certified(step.normal),
                                 .point = certified(step.point),
                                 .at = step.at});
  return certificate;
}

}  // namespace collided::engine::service
