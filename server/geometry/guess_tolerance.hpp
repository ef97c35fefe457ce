#pragma once

/// Tolerances of guesses and of margins, whose choices are decided exactly afterwards. A poor value costs time, or a
/// proof that another try must find; it never changes an answer.
namespace collided::engine {

/// Replaces a size or a square that has vanished, so that a quotient by it is finite; any number above 0 would do,
/// since the dividend has vanished too. Unit: that of the divisor.
inline constexpr double kVanishingSquare = 1e-300;

/// Components of a unit direction below this are tried as 0: in axis-aligned scenes the true direction has none, and
/// the search that found it stops some 1e-8 of the size before the truth. No unit.
inline constexpr double kSquaredUp = 1e-7;

/// Relative margin that widens a region of search: some hundred roundings reach 1e-14, the margin is a hundred thousand
/// times that, and adds no candidate in a million. No unit.
inline constexpr double kSearchMargin = 1e-9;

/// Narrowest and widest time bracket for a sweep, as a fraction of its motion: below the first, roundings of the motion
/// are as wide; above the second, a bracket hardly locates the time. No unit.
inline constexpr double kNarrowestBracket = 1e-12;
inline constexpr double kWidestBracket = 1e-3;

}  // namespace collided::engine
