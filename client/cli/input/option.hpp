#pragma once

#include <algorithm>
#include <chrono>
#include <concepts>
#include <cstdint>
#include <optional>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include <CLI/CLI.hpp>

#include "client/cli/failure.hpp"
#include "client/cli/input/number.hpp"

// One declaration of an option provides the parser, the units of its value, its line in the help with the value's name,
// and completion in a shell.
namespace collided::cli {

/// Declares an option; the value becomes the result of `read` for the given text.
///
/// declared  its names and, after a blank, the name of its value: "-o,--out FILE". For arguments without a name "names
///           GLOB": a word for each, the last word for all further ones. A shell offers objects for OBJECT and GLOB,
///           and the words of "a|b".
template <class Given = std::string, class Value, class Read>
CLI::Option* read_option(CLI::App& app, const std::string& declared, Value& value, std::string meaning, Read read) {
  const std::size_t end = std::min(declared.find(' '), declared.size());
  const auto take = [&value, read = std::move(read)](const Given& given) { value = read(given); };
  return app.add_option_function<Given>(declared.substr(0, end), take, std::move(meaning))
      ->type_name(declared.substr(std::min(end + 1, declared.size())));
}

template <class Value, class Meant>
concept Holds = std::same_as<Value, Meant> || std::same_as<Value, std::optional<Meant>>;

/// Declares an option whose value's type decides how it is read and named: TIME, N (a count of at least 1) or BITS.
/// Texts are kept unchanged; `declared` names them.
template <class Value>
CLI::Option* option(CLI::App& app, const std::string& declared, Value& value, std::string meaning) {
  if constexpr (Holds<Value, std::chrono::nanoseconds>) {
    return read_option(app, declared + " TIME", value, std::move(meaning), parse_duration);
  } else if constexpr (Holds<Value, std::uint64_t>) {
    return read_option(app, declared + " N", value, std::move(meaning),
                       [](const std::string& text) { return parse_count(text, 1); });
  } else if constexpr (Holds<Value, std::uint32_t>) {
    return read_option(app, declared + " BITS", value, std::move(meaning), parse_bits);
  } else {
    using Given = std::conditional_t<Holds<Value, std::string>, std::string, Value>;
    return read_option<Given>(app, declared, value, std::move(meaning), [](const Given& given) { return given; });
  }
}

enum class Infinity { refused, taken };

/// Declares an option that takes a number of 0 or more with a unit: LENGTH or ANGLE.
template <Holds<double> Value>
CLI::Option* option(CLI::App& app, const std::string& names, Measure measure, Value& value, std::string meaning,
                    Infinity infinity = Infinity::refused) {
  return read_option(app, names + (measure == Measure::angle ? " ANGLE" : " LENGTH"), value, std::move(meaning),
                     [=, name = names.substr(0, names.find(','))](const std::string& text) {
                       const double number =
                           infinity == Infinity::taken ? parse_number(text, measure) : parse_finite(text, measure);
                       if (number < 0) throw bad_use(name + ' ' + text + " is below 0");
                       return number;
                     });
}

/// The long names of the options.
inline std::vector<std::string> option_names(const CLI::App& app) {
  std::vector<std::string> names;
  for (const CLI::Option* option : app.get_options()) {
    for (const std::string& name : option->get_lnames()) names.push_back("--" + name);
  }
  return names;
}

}  // namespace collided::cli
