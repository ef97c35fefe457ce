#include "server/intake/readers/polynomial_text.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <stdexcept>
#include <string>

#include "server/intake/readers/reading.hpp"

namespace collided::engine {
namespace {

using Kind = PolynomialStep::Kind;

constexpr int kMostParentheses = 64;

/// Parses a polynomial by recursive descent into steps for a stack machine, and tracks the stack's depth.
///
/// sum     = ['+' | '-'] product {('+' | '-') ['+' | '-'] product}
/// product = power {'*' ['+' | '-'] power}
/// power   = atom ['^' whole number]
/// atom    = number | 'x' | 'y' | 'z' | '(' sum ')'
class PolynomialReader {
 public:
  explicit PolynomialReader(std::string_view text) : text_(text) {}

  ImplicitSurface read() {
    if (text_.size() > kMaxPolynomialBytes) {
      throw std::invalid_argument(
          fmt::format("{} bytes of polynomial, at most {} are read", text_.size(), kMaxPolynomialBytes));
    }
    surface_.degree = sum();
    if (next_is_word("in")) read_box();
    if (at_end() && surface_.degree == 0) complain("there is no x, y or z in it: a constant has no surface");
    if (!at_end()) complain(fmt::format("{}; expected + - * ^, 'in' and a box, or the end", found()));
    return std::move(surface_);
  }

 private:
  /// Each of these returns the degree of what it has parsed.
  int sum() {
    int degree = signed_product();
    for (char sign = skip_one_of("+-"); sign != 0; sign = skip_one_of("+-")) {
      degree = std::max(degree, signed_product());
      emit({.kind = sign == '+' ? Kind::add : Kind::subtract, .exponent = 0, .constant = 0}, -1);
    }
    return degree;
  }

  int signed_product() {
    const bool negative = skip_one_of("+-") == '-';
    const int degree = product();
    if (negative) emit({.kind = Kind::negate, .exponent = 0, .constant = 0}, 0);
    return degree;
  }

  int product() {
    int degree = power();
    while (skip_one_of("*") != 0) {
      const bool negative = skip_one_of("+-") == '-';
      degree = checked_degree(degree + power());
      if (negative) emit({.kind = Kind::negate, .exponent = 0, .constant = 0}, 0);
      emit({.kind = Kind::multiply, .exponent = 0, .constant = 0}, -1);
    }
    return degree;
  }

  int power() {
    const int degree = atom();
    if (skip_one_of("^") == 0) return degree;
    skip_blanks();
    unsigned exponent = 0;
    const auto [stop, error] = std::from_chars(text_.data() + at_, text_.data() + text_.size(), exponent);
    if (error == std::errc::invalid_argument)
      complain(fmt::format("{} after ^; a whole number from 0 to {} is needed", found(), ImplicitSurface::kMostDegree));
    if (error != std::errc{} || exponent > ImplicitSurface::kMostDegree) {
      complain(fmt::format("exponent {}, allowed are 0 to {}",
                           in_quotes(text_.substr(at_, static_cast<std::size_t>(stop - text_.data()) - at_)),
                           ImplicitSurface::kMostDegree));
    }
    at_ = static_cast<std::size_t>(stop - text_.data());
    emit({.kind = Kind::power, .exponent = static_cast<std::uint8_t>(exponent), .constant = 0}, 0);
    return checked_degree(degree * static_cast<int>(exponent));
  }

  int atom() {
    skip_blanks();
    if (skip_one_of("(") != 0) return in_parentheses();
    const char c = at_end() ? '\0' : text_[at_];
    if (c == 'x' || c == 'y' || c == 'z') {
      ++at_;
      emit({.kind = c == 'x' ? Kind::x : c == 'y' ? Kind::y : Kind::z, .exponent = 0, .constant = 0}, 1);
      return 1;
    }
    if (!(c == '.' || (c >= '0' && c <= '9'))) complain(fmt::format("{}; a number, x, y, z or '(' is needed", found()));
    emit({.kind = Kind::constant, .exponent = 0, .constant = number()}, 1);
    return 0;
  }

  int in_parentheses() {
    if (++parentheses_ > kMostParentheses)
      complain(fmt::format("more than {} parentheses within each other", kMostParentheses));
    const int degree = sum();
    if (skip_one_of(")") == 0) complain(fmt::format("{}; expected + - * ^ or ')'", found()));
    --parentheses_;
    return degree;
  }

  double number() {
    double value = 0;
    const auto [stop, error] = std::from_chars(text_.data() + at_, text_.data() + text_.size(), value);
    const std::string_view digits = text_.substr(at_, static_cast<std::size_t>(stop - text_.data()) - at_);
    if (error == std::errc::invalid_argument) complain(fmt::format("{} is no number", found()));
    // A number that is too small for a double is refused: with 0 instead it would be another polynomial.
    if (error != std::errc{} || !std::isfinite(value))
      complain(fmt::format("number {} is beyond the doubles (4.9e-324 to 1.8e308)", in_quotes(digits)));
    at_ += digits.size();
    return value;
  }

  void read_box() {
    at_ += 2;
    for (Vec3* corner : {&surface_.low, &surface_.high}) {
      for (double& coordinate : *corner) {
        const bool negative = skip_one_of("+-") == '-';
        skip_blanks();
        const bool digit = !at_end() && (text_[at_] == '.' || (text_[at_] >= '0' && text_[at_] <= '9'));
        if (!digit)
          complain(fmt::format("{}; a box takes six finite numbers, its lowest and its highest corner", found()));
        coordinate = negative ? -number() : number();
        skip_one_of(",");
      }
    }
    for (int axis = 0; axis < 3; ++axis) {
      if (!(surface_.low[axis] <= surface_.high[axis])) {
        complain(fmt::format("the box is empty: along {} from {} to {}", "xyz"[axis], surface_.low[axis],
                             surface_.high[axis]));
      }
    }
  }

  int checked_degree(int degree) const {
    if (degree > ImplicitSurface::kMostDegree) {
      complain(fmt::format("degree {} as written, at most {} is taken", degree, ImplicitSurface::kMostDegree));
    }
    return degree;
  }

  void emit(const PolynomialStep& step, int grows_by) {
    stack_ += grows_by;
    if (stack_ > ImplicitSurface::kMostStack) {
      complain(
          fmt::format("more than {} values wait for their operator: fewer parentheses to the right of + - * are needed",
                      ImplicitSurface::kMostStack));
    }
    if (surface_.steps.size() == ImplicitSurface::kMostSteps) {
      complain(fmt::format("more than {} numbers, variables and operators", ImplicitSurface::kMostSteps));
    }
    surface_.steps.push_back(step);
  }

  void skip_blanks() {
    // A backslash at a line's end joins two lines of a file.
    while (!at_end() && (std::string_view(" \t\r\n\v\f").find(text_[at_]) != std::string_view::npos || joins_lines()))
      ++at_;
  }
  bool joins_lines() const {
    const std::string_view rest = text_.substr(at_);
    return rest.starts_with("\\\n") || rest.starts_with("\\\r\n");
  }
  bool at_end() const { return at_ == text_.size(); }

  /// Steps over one of these characters and returns it; 0 if none comes next.
  char skip_one_of(std::string_view characters) {
    skip_blanks();
    if (at_end() || characters.find(text_[at_]) == std::string_view::npos) return 0;
    return text_[at_++];
  }
  bool next_is_word(std::string_view word) {
    skip_blanks();
    return text_.substr(at_).starts_with(word);
  }

  std::string found() const {
    if (at_end()) return "the end";
    const char c = text_[at_];
    const bool continues = (c >= '0' && c <= '9') || c == '.' || c == '(' || c == 'x' || c == 'y' || c == 'z';
    std::string hint;
    if (continues) hint = " without an operator before it: products are written with *";
    if (c == '/') hint = ": a quotient is no polynomial; of a number, write 0.5*x";
    return in_quotes(text_.substr(at_, 1)) + hint;
  }
  [[noreturn]] void complain(const std::string& what) const {
    throw std::invalid_argument(fmt::format("column {}: {}", at_ + 1, what));
  }

  std::string_view text_;
  std::size_t at_ = 0;
  int stack_ = 0;
  int parentheses_ = 0;
  ImplicitSurface surface_;
};

}  // namespace

ImplicitSurface read_implicit_surface(std::string_view text) { return PolynomialReader(text).read(); }

}  // namespace collided::engine
