#include "tests/studies/report/page/page_check.hpp"

#include <cctype>
#include <fstream>
#include <set>
#include <sstream>

#include "tests/studies/report/page/rows.hpp"

namespace collided::report {
namespace {

bool is_name(char c) { return std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '-' || c == ':' || c == '_'; }

std::string_view take_name(std::string_view& rest) {
  std::size_t length = 0;
  while (length < rest.size() && is_name(rest[length])) ++length;
  const std::string_view name = rest.substr(0, length);
  rest.remove_prefix(length);
  return name;
}

std::string entity_fault(std::string_view text) {
  for (std::size_t at = text.find('&'); at != std::string_view::npos; at = text.find('&', at + 1)) {
    const std::string_view entity = text.substr(at, text.find(';', at) - at + 1);
    if (entity != "&amp;" && entity != "&lt;" && entity != "&gt;" && entity != "&quot;") return "a bare &";
  }
  return text.find('<') == std::string_view::npos ? "" : "a bare <";
}

/// Attributes up to the end of a tag, which stays in `rest`.
std::string attribute_fault(std::string_view& rest) {
  std::set<std::string_view> seen;
  while (!rest.empty() && rest[0] == ' ') {
    rest.remove_prefix(1);
    const std::string_view name = take_name(rest);
    if (name.empty() || !seen.insert(name).second) return "attribute '" + std::string(name) + "' empty or given twice";
    if (!rest.starts_with("=\"")) return "attribute '" + std::string(name) + "' without quotes";
    const std::size_t end = rest.find('"', 2);
    if (end == std::string_view::npos) return "attribute '" + std::string(name) + "' without its end";
    if (const std::string fault = entity_fault(rest.substr(2, end - 2)); !fault.empty()) return fault;
    rest.remove_prefix(end + 1);
  }
  return "";
}

/// Things drawn beside the paper, axes and texts.
bool shows_data(std::string_view svg) {
  std::size_t rectangles = 0;
  for (std::size_t at = svg.find("<rect"); at != std::string_view::npos; at = svg.find("<rect", at + 1)) ++rectangles;
  return svg.find("<circle") != std::string_view::npos || svg.find("<path") != std::string_view::npos || rectangles > 2;
}

std::string read(const std::filesystem::path& file) {
  std::ifstream in(file);
  std::ostringstream text;
  text << in.rdbuf();
  return text.str();
}

}  // namespace

std::string xml_fault(std::string_view rest) {
  std::vector<std::string_view> open;
  while (!rest.empty()) {
    const std::size_t tag = std::min(rest.find('<'), rest.size());
    if (const std::string fault = entity_fault(rest.substr(0, tag)); !fault.empty()) return fault;
    rest.remove_prefix(tag);
    if (rest.empty()) break;
    rest.remove_prefix(1);
    const bool closes = rest.starts_with("/");
    if (closes) rest.remove_prefix(1);
    const std::string_view name = take_name(rest);
    if (name.empty()) return "a tag without a name";
    if (closes) {
      if (open.empty() || open.back() != name) return "</" + std::string(name) + "> closes nothing";
      open.pop_back();
    } else {
      if (const std::string fault = attribute_fault(rest); !fault.empty()) return fault;
      if (rest.starts_with("/")) {
        rest.remove_prefix(1);
      } else {
        open.push_back(name);
      }
    }
    if (!rest.starts_with(">")) return "<" + std::string(name) + " has no end";
    rest.remove_prefix(1);
  }
  return open.empty() ? "" : "<" + std::string(open.back()) + "> is not closed";
}

std::vector<std::string> page_complaints(const std::filesystem::path& folder) {
  std::vector<std::string> result;
  const std::string page = read(folder / "index.html");
  std::size_t figures = 0;
  for (std::size_t at = page.find("href=\"#"); at != std::string::npos; at = page.find("href=\"#", at + 1)) {
    const std::string id = page.substr(at + 7, page.find('"', at + 7) - at - 7);
    ++figures;
    if (page.find("<section id=\"" + id + "\">") == std::string::npos) result.push_back("no figure '" + id + "'");
  }
  if (figures < 10) result.push_back("only " + std::to_string(figures) + " figures in the contents");
  std::size_t drawings = 0;
  for (std::size_t at = page.find("<svg"); at != std::string::npos; at = page.find("<svg", at + 1)) {
    const std::size_t end = page.find("</svg>", at);
    const std::string_view svg = std::string_view(page).substr(at, end == std::string::npos ? end : end + 6 - at);
    const std::string name = "drawing " + std::to_string(++drawings);
    if (const std::string fault = xml_fault(svg); !fault.empty()) result.push_back(name + ": " + fault);
    if (!shows_data(svg)) result.push_back(name + ": shows nothing");
    if (svg.find("nan") != std::string_view::npos) result.push_back(name + ": a coordinate is not a number");
  }
  if (drawings < 10) result.push_back("only " + std::to_string(drawings) + " drawings");
  const Csv rows = read_csv(folder / "rows.csv");
  if (rows.rows.size() < 50) result.push_back("only " + std::to_string(rows.rows.size()) + " rows");
  for (std::size_t i = 0; i < rows.rows.size(); ++i) {
    if (!(rows.number(i, "bound_ratio") > 1)) continue;
    result.push_back(rows.text(i, "study") + ", " + rows.text(i, "series") + ", " + rows.text(i, "label") + ": error " +
                     rows.text(i, "bound_ratio") + " times its bound");
  }
  return result;
}

}  // namespace collided::report
