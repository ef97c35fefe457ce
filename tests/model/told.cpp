#include "tests/model/told.hpp"

#include <gtest/gtest.h>

#include <algorithm>

namespace collided::model {
using namespace engine;
namespace {

std::string number(double x) { return line(" %a", x + 0.0); }

/// As if the other of the two were named first.
Event turned_round(Event event) {
  std::swap(event.of.a, event.of.b);
  std::swap(event.of.a_triangle, event.of.b_triangle);
  event.of.contact.normal = -event.of.contact.normal;
  event.of.surface.normal = -event.of.surface.normal;
  event.relative_velocity = -event.relative_velocity;
  return event;
}

std::string line_of(const AnswerHit& hit, const NamesById& names, const AnswerDetail& detail) {
  std::string text = "  " + names.of(hit.object) + line(" triangle %u flags %u", hit.triangle, hit.flags);
  text += number(hit.distance_m) + number(hit.error_m) + " exit" + number(hit.exit_m) + " at" + told(hit.point);
  text += " normal" + told(hit.normal) + " weights" + told(hit.weights);
  if (detail.point_error) text += " point error" + number(hit.point_error_m);
  return text;
}

}  // namespace

std::string told(const Vec3& v) { return number(v.x()) + number(v.y()) + number(v.z()); }

Lines told(const Answers& answers, const NamesById& names, const AnswerDetail& detail) {
  Lines lines;
  if (detail.age) lines.push_back(line("oldest pose %lld", static_cast<long long>(answers.oldest_pose_ns)));
  std::size_t next = 0;
  for (std::size_t i = 0; i < answers.answers.size(); ++i) {
    std::string text =
        line("answer %d reason %d", static_cast<int>(answers.answers[i]), static_cast<int>(answers.reasons[i]));
    if (detail.cost)
      text += line(" level %d nodes %u tests %u", answers.levels[i], answers.nodes[i], answers.exact_tests[i]);
    lines.push_back(text);
    if (detail.hits && !answers.brackets.empty()) {
      for (std::uint32_t k = 0; k < answers.hit_counts[i]; ++k) {
        const TimeBracket& bracket = answers.brackets.at(next + k);
        lines.push_back("  bracket" + number(bracket.low) + number(bracket.high));
      }
    }
    for (std::uint32_t k = 0; k < answers.hit_counts[i]; ++k, ++next) {
      if (detail.hits) lines.push_back(line_of(answers.hits.at(next), names, detail));
    }
  }
  for (const NotCovered& entry : answers.not_covered) {
    lines.push_back(line("not covered %u", entry.question) + told(entry.leaving.point) +
                    number(entry.leaving.covered_m));
  }
  return lines;
}

std::pair<std::string, std::string> pair_of(const OpenContact& contact, const NamesById& names) {
  const std::string a = names.of(contact.a), b = names.of(contact.b);
  return std::minmax(a, b);
}

std::string told(const Event& given, const NamesById& names, const ContactDetail& detail) {
  const Event event = names.of(given.of.b) < names.of(given.of.a) ? turned_round(given) : given;
  std::string text = names.of(event.of.a) + " " + names.of(event.of.b);
  text += line(" kind %d reason %d", static_cast<int>(event.kind), static_cast<int>(event.reason));
  text += " bracket" + number(event.bracket_low_s) + number(event.bracket_high_s);
  if (!detail.point) return text;
  text += " velocity" + told(event.relative_velocity);
  text += line(" triangles %u %u at", event.of.a_triangle, event.of.b_triangle) + told(event.of.contact.point);
  text += " normal" + told(event.of.contact.normal) + " depth" + number(event.of.contact.depth_m) +
          number(event.of.contact.depth_error_m);
  if (!detail.surface) return text;
  return text + " surface" + told(event.of.surface.normal) + " depth" + number(event.of.surface.depth_m) +
         number(event.of.surface.depth_error_m);
}

std::string told(const OpenContact& contact, const NamesById& names, const ContactDetail& detail) {
  Event event;
  event.of = contact;
  return told(event, names, detail);
}

Lines told(const PairReport& report) {
  Lines lines{line("touches %d contained %d triangles %u %u", static_cast<int>(report.touches),
                   static_cast<int>(report.contained), report.a_triangle, report.b_triangle)};
  lines.push_back("contact" + told(report.contact.point) + told(report.contact.normal) +
                  number(report.contact.depth_m) + number(report.contact.depth_error_m));
  const Separation& apart = report.separation;
  lines.push_back("apart" + number(apart.distance_m) + number(apart.error_m) + told(apart.on_a) + told(apart.on_b) +
                  told(apart.normal) + number(apart.point_error_m));
  for (const ManifoldPoint& point : report.manifold) {
    lines.push_back("bears" + told(point.point) + number(point.depth_m) + number(point.depth_error_m) +
                    line(" %u %u", point.a_triangle, point.b_triangle));
  }
  return lines;
}

std::string told(const ProbeReading& reading, const NamesById& names) {
  return (reading.object == 0 ? "absent" : names.of(reading.object)) +
         line(" state %d", static_cast<int>(reading.state)) + number(reading.clearance_m) + number(reading.error_m) +
         " met " + (reading.met == 0 ? "" : names.of(reading.met)) + line(" triangle %u at", reading.triangle) +
         told(reading.point) + told(reading.normal);
}

void expect_same(const Lines& here, const Lines& twin, const std::string& what) {
  if (here == twin) return;
  std::string text = what;
  for (const std::string& line : here) {
    if (std::find(twin.begin(), twin.end(), line) == twin.end()) text += "\n  here: " + line;
  }
  for (const std::string& line : twin) {
    if (std::find(here.begin(), here.end(), line) == here.end()) text += "\n  twin: " + line;
  }
  ADD_FAILURE() << text;
}

}  // namespace collided::model
