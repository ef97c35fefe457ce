#include "server/programs/files/implicit.hpp"

#include <fmt/format.h>

#include <array>
#include <charconv>
#include <cmath>
#include <cstdio>
#include <iostream>
#include <limits>
#include <nlohmann/json.hpp>
#include <stdexcept>

#include "server/exact_phase/arithmetic/precision.hpp"
#include "server/exact_phase/ray/implicit_ray.hpp"
#include "server/intake/file_bytes.hpp"
#include "server/intake/readers/implicit_lines.hpp"
#include "server/programs/files/file_options.hpp"

namespace collided::engine::files {
namespace {

using nlohmann::json;

constexpr int kYes = 0;
constexpr int kNo = 1;
constexpr int kUndecided = 3;
constexpr int kSomeRefused = 6;
constexpr std::size_t kMaxLineBytes = 4096;

ImplicitSurface surface_of(const ImplicitOptions& options) {
  if (options.file.empty()) {
    try {
      return read_implicit_surface(options.surface);
    } catch (const std::invalid_argument& wrong) {
      throw LoadError(
          fmt::format("implicit: '{}', {}. Nothing was asked.", options.surface.substr(0, 80), wrong.what()));
    }
  }
  LoadReport report;
  const LoadOptions reading_options;
  const FileBytes bytes(options.file, FileBytes::Access::copied, reading_options);
  const std::optional<ImplicitSurface> found =
      find_implicit_surface({file_name(options.file), bytes.bytes(), reading_options, report}, options.surface);
  if (!found)
    throw LoadError(
        fmt::format("{}: no line has the name '{}'. Nothing was asked.", file_name(options.file), options.surface));
  return *found;
}

double finite_number(const std::string& word) {
  double value = 0;
  const char* const begin = word.data() + (word.size() > 1 && word[0] == '+' && word[1] != '-' ? 1 : 0);
  const auto [end, error] = std::from_chars(begin, word.data() + word.size(), value);
  if (error != std::errc{} || end != word.data() + word.size() || !std::isfinite(value))
    throw LoadError(fmt::format("'{}' is no finite number", word.substr(0, 40)));
  return value;
}

/// The three numbers of a point or the six of a ray. Throws LoadError.
std::vector<double> question_of(const std::vector<std::string>& words) {
  std::vector<double> numbers;
  for (const std::string& word : words) numbers.push_back(finite_number(word));
  if (numbers.size() != 3 && numbers.size() != 6) {
    throw LoadError(fmt::format("{} numbers; a point X Y Z or a ray X Y Z DX DY DZ is needed", numbers.size()));
  }
  if (numbers.size() == 6 && numbers[3] == 0 && numbers[4] == 0 && numbers[5] == 0)
    throw LoadError("direction 0 0 0 has no direction");
  return numbers;
}

/// JSON has no infinity; it is written as text.
json number_json(double value) { return std::isfinite(value) ? json(value) : json(value > 0 ? "inf" : "-inf"); }
json exact_json(const Vec3& point) { return {number_json(point.x()), number_json(point.y()), number_json(point.z())}; }
std::string exact_text(const Vec3& point) {
  return fmt::format("{} {} {}", shortest(point.x()), shortest(point.y()), shortest(point.z()));
}
const char* level_name(const ExactResult& verdict) {
  return verdict.level == Level::filter ? "double" : verdict.level == Level::expansion ? "expansions" : "rationals";
}

std::string normal_text(const ImplicitHit& hit) {
  if (hit.normal_state == ImplicitHit::Normal::singular) return "no normal: the gradient is 0 there";
  if (hit.normal_state == ImplicitHit::Normal::undecided) return "normal undecided: too near to a point without";
  return fmt::format("normal {} ±{:.2g}", exact_text(hit.normal), hit.normal_error);
}

void print_hit(const ExactResult& verdict, const ImplicitHit& hit, bool as_json) {
  if (!as_json) {
    fmt::print("hit  distance {} ±{:.2g}  at {}  {}  t in [{}, {}]{}\n", shortest(hit.distance_m), hit.distance_error_m,
               exact_text(hit.point), normal_text(hit), shortest(hit.low), shortest(hit.high),
               hit.runs_along ? "  runs along the surface from there" : "");
    return;
  }
  json answer{{"answer", "hit"},
              {"distance", number_json(hit.distance_m)},
              {"error", number_json(hit.distance_error_m)},
              {"low", hit.low},
              {"high", number_json(hit.high)},
              {"point", exact_json(hit.point)},
              {"point_error", number_json(hit.point_error_m)},
              {"by", level_name(verdict)}};
  if (hit.normal_state == ImplicitHit::Normal::known) {
    answer["normal"] = exact_json(hit.normal);
    answer["normal_error"] = hit.normal_error;
  } else {
    answer["no_normal"] = hit.normal_state == ImplicitHit::Normal::singular ? "singular" : "undecided";
  }
  if (hit.runs_along) answer["runs_along"] = true;
  std::puts(answer.dump().c_str());
}

void print_word(const char* word, const ExactResult& verdict, bool as_json) {
  std::puts(as_json ? json{{"answer", word}, {"by", level_name(verdict)}}.dump().c_str() : word);
}

int ask_ray(const ImplicitSurface& surface, const Ray& ray, bool as_json) {
  ImplicitHit hit;
  const ExactResult verdict = cast_ray(ray, surface, hit);
  if (verdict.yes()) {
    print_hit(verdict, hit, as_json);
    return kYes;
  }
  const bool missed = verdict.decision == Decision::no;
  print_word(missed ? "miss" : "undecided", verdict, as_json);
  return missed ? kNo : kUndecided;
}

int ask_point(const ImplicitSurface& surface, const Vec3& point, bool as_json) {
  Side side = Side::outside;
  const ExactResult verdict = side_of(point, surface, side);
  if (!verdict.yes()) {
    print_word("undecided", verdict, as_json);
    return kUndecided;
  }
  print_word(side == Side::inside ? "inside" : side == Side::on ? "on" : "outside", verdict, as_json);
  return side == Side::outside ? kNo : kYes;
}

int ask(const ImplicitSurface& surface, const std::vector<double>& n, double length_m, bool as_json) {
  if (n.size() == 3) return ask_point(surface, {n[0], n[1], n[2]}, as_json);
  return ask_ray(surface, {{n[0], n[1], n[2]}, {n[3], n[4], n[5]}, length_m}, as_json);
}

std::vector<std::string> words_of(const std::string& line) {
  std::vector<std::string> words;
  std::string word;
  for (const char c : line + ' ') {
    const bool separates = c == ' ' || c == '\t' || c == ',' || c == '\r';
    if (!separates) word += c;
    if (separates && !word.empty()) words.push_back(std::move(word)), word.clear();
  }
  return words;
}

/// Reads a line from stdin; false at the end. Only the beginning of a line that is too long is kept, for the error
/// message.
bool next_line(std::string& line, bool& too_long) {
  std::array<char, kMaxLineBytes + 1> buffer{};
  std::cin.getline(buffer.data(), buffer.size());
  line = buffer.data();
  too_long = std::cin.fail() && line.size() == kMaxLineBytes;
  if (too_long) {
    std::cin.clear();
    std::cin.ignore(std::numeric_limits<std::streamsize>::max(), '\n');
  }
  return too_long || !std::cin.fail();
}

/// Answers each line of stdin, except empty ones and those that begin with #.
int ask_lines(const ImplicitSurface& surface, double length_m, bool as_json) {
  bool refused = false;
  bool too_long = false;
  std::string line;
  for (std::size_t number = 1; next_line(line, too_long); ++number) {
    const std::vector<std::string> words = words_of(line);
    if (words.empty() || words.front().starts_with('#')) continue;
    try {
      if (too_long) throw LoadError(fmt::format("longer than {} bytes", kMaxLineBytes));
      ask(surface, question_of(words), length_m, as_json);
    } catch (const LoadError& wrong) {
      refused = true;
      std::puts(as_json ? "{\"answer\":\"invalid\"}" : "invalid");
      fmt::print(stderr, "error: stdin line {}: {}; this one refused, the others answered\n", number, wrong.what());
    }
  }
  return refused ? kSomeRefused : kYes;
}

double length_of(const std::string& text) {
  if (text.empty() || text == "inf") return std::numeric_limits<double>::infinity();
  const double length_m = finite_number(text);
  if (!(length_m >= 0)) throw LoadError(fmt::format("--length {}; it must not be below 0", text));
  return length_m;
}

}  // namespace

int implicit(const ImplicitOptions& options) {
  const ImplicitSurface surface = surface_of(options);
  const double length_m = length_of(options.length);
  const PrecisionScope precision(
      {.highest = Level::rational,
       .error_asked_m = options.within.empty() ? 0 : length_in_metres("--within", options.within)});
  if (options.numbers == std::vector<std::string>{"-"}) return ask_lines(surface, length_m, options.as_json);
  return ask(surface, question_of(options.numbers), length_m, options.as_json);
}

}  // namespace collided::engine::files
