#pragma once

#include "collided/certificate.hpp"
#include "server/exact_phase/proof.hpp"

namespace collided::engine {

inline CertifiedPart::Numbers numbers(const Vec3& v) { return {v.x(), v.y(), v.z()}; }

inline CertifiedPart certified(const ProofPart& proof_part) {
  const PartNumbers from = numbers_of(proof_part.part);
  CertifiedPart part{.summand = static_cast<CertifiedPart::Summand>(from.summand),
                     .radius_m = from.radius_m,
                     .tapers = from.tapers,
                     .half_m = numbers(from.half_m)};
  for (const Vec3& point : from.points) part.points.push_back(numbers(point));
  for (int k = 0; k < 3; ++k) part.axes[static_cast<std::size_t>(k)] = numbers(from.axes.col(k));
  return part;
}

/// As it travels, but for the wire.
inline Certificate certified(const Proof& proof) {
  Certificate certificate{.touches = proof.touches,
                          .point = {proof.point[0], proof.point[1], proof.point[2]},
                          .divisor = proof.divisor,
                          .mix_a = proof.mix_a,
                          .mix_b = proof.mix_b};
  for (const ProofPart& part : proof.a) certificate.a.push_back(certified(part));
  for (const ProofPart& part : proof.b) certificate.b.push_back(certified(part));
  for (const ProofStep& step : proof.steps) {
    certificate.steps.push_back(
        {static_cast<Certificate::Step::Kind>(step.kind), numbers(step.normal), numbers(step.point), step.at});
  }
  return certificate;
}

}  // namespace collided::engine
