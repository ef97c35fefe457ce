#include "client/cli/input/tokens.hpp"

#include <array>
#include <fstream>
#include <iterator>

#include <fmt/format.h>

#include "client/cli/failure.hpp"
#include "client/cli/input/number.hpp"

namespace collided::cli {
namespace {

// The mark: arguments do not begin with this byte by accident, and the option parser takes a marked token for a plain
// word.
constexpr char kMark = '\x01';
constexpr std::size_t kMostFileBytes = 1 << 20;

struct VectorOption {
  std::string_view name;
  std::size_t most_numbers;
};
constexpr std::array kVectorOptions{VectorOption{"--to", 3},     VectorOption{"--at", 3},   VectorOption{"--rpy", 3},
                                    VectorOption{"--to-rpy", 3}, VectorOption{"--dir", 3},  VectorOption{"--center", 3},
                                    VectorOption{"--size", 3},   VectorOption{"--from", 3}, VectorOption{"--quat", 4},
                                    VectorOption{"--origin", 3}, VectorOption{"--up", 3},   VectorOption{"--light", 3},
                                    VectorOption{"--ray", 6}};

std::size_t numbers_after(std::string_view option) {
  for (const VectorOption& entry : kVectorOptions) {
    if (entry.name == option) return entry.most_numbers;
  }
  return 0;
}

std::vector<std::string> words_of_file(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  if (!file) throw bad_use(fmt::format("@{}: cannot open that file", path));
  std::string text(kMostFileBytes + 1, '\0');
  file.read(text.data(), static_cast<std::streamsize>(text.size()));
  text.resize(static_cast<std::size_t>(file.gcount()));
  if (text.size() > kMostFileBytes)
    throw bad_use(fmt::format("@{}: more than {} bytes of arguments", path, kMostFileBytes));
  std::vector<std::string> words;
  std::size_t begin = 0;
  while (begin < text.size()) {
    const std::size_t end = std::min(text.find('\n', begin), text.size());
    for (std::string& word : split_words(std::string_view(text).substr(begin, end - begin)))
      words.push_back(std::move(word));
    begin = end + 1;
  }
  return words;
}

std::vector<std::string> expand_files(const std::vector<std::string>& arguments) {
  std::vector<std::string> expanded;
  bool options_ended = false;
  for (const std::string& argument : arguments) {
    if (argument == "--") options_ended = true;
    if (!options_ended && argument.size() > 1 && argument[0] == '@') {
      for (std::string& word : words_of_file(argument.substr(1))) expanded.push_back(std::move(word));
    } else {
      expanded.push_back(argument);
    }
  }
  return expanded;
}

}  // namespace

std::vector<std::string> prepare_tokens(const std::vector<std::string>& arguments) {
  const std::vector<std::string> words = expand_files(arguments);
  std::vector<std::string> tokens;
  for (std::size_t at = 0; at < words.size(); ++at) {
    if (words[at] == "--") {
      for (++at; at < words.size(); ++at) tokens.push_back(kMark + words[at]);
      break;
    }
    // The option parser would take "[ab]" as a list.
    if (is_number_text(words[at]) || words[at].starts_with('[')) {
      tokens.push_back(kMark + words[at]);
      continue;
    }
    tokens.push_back(words[at]);
    std::size_t wanted = numbers_after(words[at]);
    std::string joined;
    while (wanted > 0 && at + 1 < words.size() && is_number_text(words[at + 1])) {
      ++at;
      const bool is_list = words[at].find(',') != std::string::npos;
      joined += (joined.empty() ? "" : ",") + words[at];
      wanted = is_list ? 0 : wanted - 1;
    }
    if (!joined.empty()) tokens.push_back(kMark + joined);
  }
  return tokens;
}

std::string unmarked(std::string token) {
  if (!token.empty() && token.front() == kMark) token.erase(0, 1);
  return token;
}

std::vector<std::string> split_words(std::string_view line) {
  std::vector<std::string> words;
  std::string word;
  bool in_word = false;
  char quote = 0;
  for (std::size_t at = 0; at < line.size(); ++at) {
    const char c = line[at];
    if (c == '\\' && quote != '\'' && at + 1 < line.size()) {
      word += line[++at];
      in_word = true;
    } else if (quote != 0) {
      if (c == quote) quote = 0;
      else word += c;
    } else if (c == '\'' || c == '"') {
      quote = c;
      in_word = true;
    } else if (c == ' ' || c == '\t' || c == '\r') {
      if (in_word) words.push_back(std::move(word));
      word.clear();
      in_word = false;
    } else if (c == '#' && !in_word) {
      break;
    } else {
      word += c;
      in_word = true;
    }
  }
  if (quote != 0) throw bad_use(fmt::format("a quote ({}) is never closed: {}", quote, line));
  if (in_word) words.push_back(std::move(word));
  return words;
}

}  // namespace collided::cli
