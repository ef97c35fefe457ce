#include "tests/studies/report/page/page.hpp"

#include <cmath>

#include "client/draw/svg.hpp"

namespace collided::report {
namespace {

using draw::escaped;

constexpr const char* kStyle = R"(
:root { color-scheme: light; }
body { background: #fbfaf6; color: #1d1d1b; font: 16px/1.5 Georgia, 'DejaVu Serif', serif; margin: 2rem auto; max-width: 60rem; padding: 0 1rem; }
h1, h2, nav, table, summary, .from { font-family: Helvetica, Arial, 'DejaVu Sans', sans-serif; }
h1 { font-size: 1.7rem; } h2 { font-size: 1.15rem; margin-top: 2.6rem; border-top: 1px solid #d9d6cc; padding-top: 1rem; }
a { color: #c8450c; } nav ol { columns: 2; font-size: .92rem; }
figure { margin: 1rem 0; } svg { max-width: 100%; height: auto; border: 1px solid #d9d6cc; }
figcaption { font-size: .92rem; color: #4a4843; margin-top: .4rem; }
table { border-collapse: collapse; font-size: .78rem; margin: .6rem 0; display: block; overflow-x: auto; }
th, td { padding: .2rem .55rem; border-bottom: 1px solid #d9d6cc; text-align: right; white-space: nowrap; }
th { border-bottom: 1.5px solid #1d1d1b; } td.t, th.t { text-align: left; }
summary { font-size: .82rem; color: #6b6860; cursor: pointer; } .from { font-size: .8rem; color: #6b6860; }
code { font-size: .88em; } .ours { color: #c8450c; }
)";

struct Column {
  const char* name;
  std::string (*text)(const Row&);
};

std::string count_text(long count) { return std::to_string(count); }

const Column kColumns[] = {
    {"knob", [](const Row& r) { return short_number(r.knob, 3); }},
    {"worst error", [](const Row& r) { return short_number(r.error_max); }},
    {"median error", [](const Row& r) { return short_number(r.error_p50); }},
    {"error / bound", [](const Row& r) { return short_number(r.bound_ratio); }},
    {"worst bound", [](const Row& r) { return short_number(r.bound_max); }},
    {"ns", [](const Row& r) { return short_number(r.ns, 3); }},
    {"ns, range",
     [](const Row& r) {
       return std::isnan(r.ns) ? std::string("-") : short_number(r.ns_low, 3) + " .. " + short_number(r.ns_high, 3);
     }},
    {"nodes", [](const Row& r) { return short_number(r.nodes, 3); }},
    {"tests", [](const Row& r) { return short_number(r.tests, 3); }},
    {"references a triangle", [](const Row& r) { return short_number(r.references, 3); }},
    {"bytes a triangle", [](const Row& r) { return short_number(r.bytes, 3); }},
    {"build, ms", [](const Row& r) { return short_number(r.build_ms, 3); }},
    {"n", [](const Row& r) { return count_text(r.n); }},
    {"missed", [](const Row& r) { return count_text(r.missed); }},
    {"false", [](const Row& r) { return count_text(r.false_hits); }},
    {"undecided", [](const Row& r) { return count_text(r.undecided); }},
};

std::string text_cell(const std::string& text) { return "<td class=\"t\">" + escaped(text) + "</td>"; }

}  // namespace

std::string rows_table(const std::vector<Row>& rows) {
  std::vector<const Column*> shown;
  for (const Column& column : kColumns) {
    for (const Row& row : rows) {
      if (column.text(row) == "-") continue;
      shown.push_back(&column);
      break;
    }
  }
  std::string html = "<table><thead><tr><th class=\"t\">scene</th><th class=\"t\">method</th><th class=\"t\"></th>";
  for (const Column* column : shown) html += std::string("<th>") + column->name + "</th>";
  html += "<th class=\"t\">note</th></tr></thead>\n<tbody>\n";
  for (const Row& row : rows) {
    html += "<tr>" + text_cell(row.scene) + text_cell(row.series) + text_cell(row.label);
    for (const Column* column : shown) html += "<td>" + column->text(row) + "</td>";
    html += text_cell(row.note) + "</tr>\n";
  }
  return html + "</tbody></table>\n";
}

Heading report_heading() {
  return {
      "Collided: error against run time",
      "What an answer costs, and how wrong it may be. Times are processor time of one thread, the median of repeats "
      "that ran in turn with every other method of the figure, with their range; errors are against rational or "
      "100-digit truth. <span class=\"ours\">Ours is in this colour.</span> A cell without data says so.",
      "rows.csv"};
}

std::string page(const std::vector<Figure>& figures, const Provenance& from, const std::string& date,
                 const Heading& heading) {
  const std::string title = escaped(heading.title);
  std::string html = "<!doctype html>\n<html lang=\"en\"><head><meta charset=\"utf-8\"/><title>" + title +
                     "</title><meta name=\"viewport\" content=\"width=device-width\"/>\n<style>" + std::string(kStyle) +
                     "</style></head>\n<body>\n<h1>" + title + "</h1>\n<p>" + heading.introduction + "</p>\n";
  html += "<p class=\"from\">" + escaped(from.machine) + " · commit " + escaped(from.commit) + " · seed " +
          std::to_string(from.seed) + " · " + escaped(date) +
          (from.quick ? " · <b>quick form: few questions</b>" : "") + "<br/>command: <code>" + escaped(from.command) +
          "</code></p>\n<nav><ol>\n";
  for (const Figure& figure : figures) {
    html += "<li><a href=\"#" + figure.id + "\">" + escaped(figure.title) + "</a></li>\n";
  }
  html += "</ol></nav>\n";
  int number = 0;
  for (const Figure& figure : figures) {
    html +=
        "<section id=\"" + figure.id + "\"><h2>" + std::to_string(++number) + ". " + escaped(figure.title) + "</h2>\n";
    html += "<figure>\n" + (figure.body.empty() ? "<p>No data: nothing was measured.</p>\n" : figure.body);
    html += "<figcaption>" + escaped(figure.caption) + " Seed " + std::to_string(from.seed) + ", commit " +
            escaped(from.commit) + ", <code>" + escaped(from.command) + "</code>.</figcaption></figure>\n";
    if (!figure.rows.empty()) html += "<details><summary>the numbers</summary>\n" + figure.rows + "</details>\n";
    html += "</section>\n";
  }
  return html + "<p class=\"from\">All rows, each with machine, commit and seed: <code>" + escaped(heading.rows_file) +
         "</code> beside this page.</p>\n</body></html>\n";
}

}  // namespace collided::report
