#pragma once

#include <array>
#include <cstddef>
#include <utility>

#include "server/exact_phase/arithmetic/polynomial.hpp"
#include "server/geometry/implicit_surface.hpp"

namespace collided::engine::kernel {

/// f along a ray, as a polynomial in the ray's parameter.
template <class N>
using RayPolynomial = Polynomial<N, ImplicitSurface::kMostDegree>;

/// A value and its derivatives by x, y, z (forward automatic differentiation: Wengert, 1964).
template <class Ring>
struct Jet {
  Ring value;
  std::array<Ring, 3> slope;
};

template <class Ring>
Jet<Ring> operator-(const Jet<Ring>& a) {
  return {-a.value, {-a.slope[0], -a.slope[1], -a.slope[2]}};
}
template <class Ring>
Jet<Ring> operator+(const Jet<Ring>& a, const Jet<Ring>& b) {
  return {a.value + b.value, {a.slope[0] + b.slope[0], a.slope[1] + b.slope[1], a.slope[2] + b.slope[2]}};
}
template <class Ring>
Jet<Ring> operator-(const Jet<Ring>& a, const Jet<Ring>& b) {
  return {a.value - b.value, {a.slope[0] - b.slope[0], a.slope[1] - b.slope[1], a.slope[2] - b.slope[2]}};
}
template <class Ring>
Jet<Ring> operator*(const Jet<Ring>& a, const Jet<Ring>& b) {
  Jet<Ring> product{a.value * b.value, {}};
  for (int axis = 0; axis < 3; ++axis) product.slope[axis] = a.slope[axis] * b.value + a.value * b.slope[axis];
  return product;
}

/// A constant in each ring.
template <class Ring>
struct ConstantOf {
  static Ring make(double c) { return Ring(c); }
};
template <class N, int kDegree>
struct ConstantOf<Polynomial<N, kDegree>> {
  static Polynomial<N, kDegree> make(double c) { return Polynomial<N, kDegree>(N(c)); }
};
template <class Ring>
struct ConstantOf<Jet<Ring>> {
  static Jet<Ring> make(double c) { return {ConstantOf<Ring>::make(c), {}}; }
};

template <class Ring>
Ring powered(const Ring& base, int exponent) {
  if (exponent == 0) return ConstantOf<Ring>::make(1);
  if (exponent == 1) return base;
  const Ring half = powered(base, exponent / 2);
  return exponent % 2 == 0 ? half * half : half * half * base;
}

/// f over any ring: numbers at a point, polynomials along a ray, or jets of either for the gradient.
template <class Ring>
Ring evaluate(const ImplicitSurface& surface, const Ring& x, const Ring& y, const Ring& z) {
  using Kind = PolynomialStep::Kind;
  std::array<Ring, ImplicitSurface::kMostStack> stack;
  std::size_t depth = 0;
  for (const PolynomialStep& step : surface.steps) {
    switch (step.kind) {
      case Kind::constant: stack[depth++] = ConstantOf<Ring>::make(step.constant); break;
      case Kind::x: stack[depth++] = x; break;
      case Kind::y: stack[depth++] = y; break;
      case Kind::z: stack[depth++] = z; break;
      case Kind::negate: stack[depth - 1] = -stack[depth - 1]; break;
      case Kind::power: stack[depth - 1] = powered(stack[depth - 1], step.exponent); break;
      case Kind::add:
        --depth;
        stack[depth - 1] = stack[depth - 1] + stack[depth];
        break;
      case Kind::subtract:
        --depth;
        stack[depth - 1] = stack[depth - 1] - stack[depth];
        break;
      case Kind::multiply:
        --depth;
        stack[depth - 1] = stack[depth - 1] * stack[depth];
        break;
    }
  }
  return std::move(stack[0]);
}

/// f along origin + t * direction.
template <class N>
RayPolynomial<N> along(const ImplicitSurface& surface, const Vector<N>& origin, const Vector<N>& direction) {
  using P = RayPolynomial<N>;
  return evaluate(surface, P(origin.x, direction.x), P(origin.y, direction.y), P(origin.z, direction.z));
}

/// A coordinate as a jet: its own derivative is 1.
template <class Ring>
Jet<Ring> coordinate(Ring value, int axis) {
  Jet<Ring> jet{std::move(value), {}};
  jet.slope[axis] = ConstantOf<Ring>::make(1);
  return jet;
}

/// The gradient of f by x, y, z.
template <class Ring>
std::array<Ring, 3> gradient(const ImplicitSurface& surface, Ring x, Ring y, Ring z) {
  return std::move(
      evaluate(surface, coordinate(std::move(x), 0), coordinate(std::move(y), 1), coordinate(std::move(z), 2)).slope);
}

}  // namespace collided::engine::kernel
