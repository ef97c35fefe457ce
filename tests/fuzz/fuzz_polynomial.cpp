#include <cmath>
#include <stdexcept>

#include "server/exact_phase/arithmetic/precision.hpp"
#include "server/exact_phase/ray/implicit_ray.hpp"
#include "server/intake/readers/polynomial_text.hpp"
#include "tests/fuzz/fuzz_target.hpp"

namespace {

using collided::engine::ImplicitSurface;
using Kind = collided::engine::PolynomialStep::Kind;

/// What the evaluation relies on without looking: the limits, and a stack that never runs empty and ends with one value.
void check_program(const ImplicitSurface& surface) {
  int stack = 0;
  for (const collided::engine::PolynomialStep& step : surface.steps) {
    const bool is_value =
        step.kind == Kind::constant || step.kind == Kind::x || step.kind == Kind::y || step.kind == Kind::z;
    const bool takes_one = step.kind == Kind::negate || step.kind == Kind::power;
    collided::fuzz::require(is_value || stack >= (takes_one ? 1 : 2), "an operator finds its values");
    stack += is_value ? 1 : takes_one ? 0 : -1;
    collided::fuzz::require(stack <= ImplicitSurface::kMostStack, "the stack holds what it must");
    collided::fuzz::require(std::isfinite(step.constant), "constants are finite");
    collided::fuzz::require(step.exponent <= ImplicitSurface::kMostDegree, "exponents are small");
  }
  collided::fuzz::require(stack == 1, "one value is left");
  collided::fuzz::require(surface.steps.size() <= ImplicitSurface::kMostSteps, "the program is short");
  collided::fuzz::require(surface.degree >= 1 && surface.degree <= ImplicitSurface::kMostDegree,
                          "the degree is within its limits");
  collided::fuzz::require((surface.low.array() <= surface.high.array()).all(), "the box is not empty");
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  try {
    const ImplicitSurface surface =
        collided::engine::read_implicit_surface({reinterpret_cast<const char*>(data), size});
    check_program(surface);
    // Double alone: what rationals cost with exponents hundreds apart is no question of the text.
    const collided::engine::PrecisionScope doubles({.highest = collided::engine::Level::filter, .error_asked_m = 0});
    collided::engine::ImplicitHit hit;
    const collided::engine::ExactResult verdict = cast_ray({{0.5, -2, 4}, {0, 0.5, -1}}, surface, hit);
    collided::fuzz::require(!verdict.yes() || (hit.low >= 0 && hit.low <= hit.high), "a bracket is one");
    collided::engine::Side side = collided::engine::Side::on;
    side_of({0.5, -2, 4}, surface, side);
  } catch (const std::invalid_argument&) {}
  return 0;
}

std::vector<std::string> fuzz_seeds() {
  return {
      "x^2+y^2+z^2-1",
      "(x^2+y^2+z^2+3)^2 - 16*(x^2+y^2) in -3 -3 -1 3 3 1",
      "-x*-y + 1e-300*(z-.5)^8 - 2.5E+3 in -1,-2,-3 1,2,3",
      "((((x+1)*(y-2)+z)*(x-y)^2-3)*z)^1 - 0*x^0 \\\n + 7",
  };
}
