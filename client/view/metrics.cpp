#include "client/view/metrics.hpp"

#include <fmt/format.h>

namespace collided::view {
namespace {

/// A label's value, in which only these three need an escape.
std::string label(std::string_view value) {
  std::string text = "\"";
  for (const char c : value) {
    if (c == '\n') text += "\\n";
    else if (c == '"' || c == '\\') text += {'\\', c};
    else text += c;
  }
  return text + '"';
}

/// Writes families one after the other: the head once, then a line for each set of labels.
class Writer {
 public:
  void head(std::string_view name, std::string_view type, std::string_view help) {
    name_ = name;
    text += fmt::format("# HELP collided_{} {}\n# TYPE collided_{} {}\n", name, help, name, type);
  }
  template <class Number>
  void line(Number number, std::string_view labels = {}) {
    put("", labels, number);
  }
  template <class Number>
  void one(std::string_view name, std::string_view type, std::string_view help, Number number) {
    head(name, type, help);
    line(number);
  }
  /// Buckets of doubled length from 1 us to 34 s, and all.
  void histogram(std::span<const DurationStep> durations, const std::string& labels) {
    constexpr std::int64_t kFirstNs = 1'000;
    constexpr int kDoublings = 25;
    const std::string comma = labels.empty() ? "" : ",";
    std::uint64_t total = 0;
    for (const DurationStep& step : durations) total += step.count;
    std::uint64_t below = 0;
    auto step = durations.begin();
    for (int doubling = 0; doubling <= kDoublings; ++doubling) {
      const std::int64_t longest_ns = kFirstNs << doubling;
      for (; step != durations.end() && step->longest_ns <= longest_ns; ++step) below += step->count;
      put("_bucket", fmt::format("{}{}le=\"{}\"", labels, comma, static_cast<double>(longest_ns) / 1e9), below);
    }
    put("_bucket", fmt::format("{}{}le=\"+Inf\"", labels, comma), total);
    put("_count", labels, total);
  }

  std::string text;

 private:
  template <class Number>
  void put(std::string_view ending, std::string_view labels, Number number) {
    text += fmt::format("collided_{}{}{}{}{} {}\n", name_, ending, labels.empty() ? "" : "{", labels,
                        labels.empty() ? "" : "}", number);
  }
  std::string name_;
};

void write_status(Writer& to, const ServerStatus& status) {
  to.head("info", "gauge", "Which server it is; always 1.");
  to.line(1, fmt::format("namespace={},version={},state={}", label(status.name_space), label(status.version_text),
                         label(status.state)));
  to.one("ready", "gauge", "1 while everything that was acknowledged is there.", status.state == "ready" ? 1 : 0);
  to.one("step_lasting_seconds", "gauge", "How long the step under way has lasted; 0 between steps and in short ones.",
         std::chrono::duration<double>(status.step_lasting).count());
  to.one("epoch", "gauge", "Grows with each start of a server.", status.epoch);
  to.one("world_version", "gauge", "Changes of the world.", status.version);
  to.one("objects", "gauge", "Objects in the world, with the parts of scenes.", status.objects);
  to.one("moving_objects", "gauge", "Of the objects, those that move.", status.moving);
  to.one("static_triangles", "gauge", "Triangles of the meshes of all scenes.", status.static_triangles);
  to.one("contacts", "gauge", "Contacts that hold.", status.contacts);
  to.one("events_total", "counter", "Contact events of this epoch.", status.last_event_sequence);
  to.head("publisher_silent_seconds", "gauge", "Time since a publisher's last message.");
  for (const PublisherInfo& publisher : status.publishers) {
    to.line(std::chrono::duration<double>(publisher.silent).count(), "publisher=" + label(publisher.name));
  }
  to.head("publisher_lost", "gauge", "1 where a publisher ended or its lease ran out.");
  for (const PublisherInfo& publisher : status.publishers)
    to.line(publisher.lost ? 1 : 0, "publisher=" + label(publisher.name));
}

void write_figures(Writer& to, const Figures& figures) {
  to.one("up_seconds", "counter", "Time since the server's start.", static_cast<double>(figures.up_ns) / 1e9);
  to.one("steps_total", "counter", "Steps of the world.", figures.steps);
  to.one("stalled_steps_total", "counter", "Times a step was tried again, since readers held every free state.",
         figures.stalled_steps);
  to.head("step_duration_seconds", "histogram", "Duration of a step.");
  to.histogram(figures.step_durations, "");
  to.head("stage_seconds_total", "counter", "Time spent in each stage of steps.");
  for (const StageTime& stage : figures.stages)
    to.line(static_cast<double>(stage.ns) / 1e9, "stage=" + label(stage.stage));
  to.one("pairs_in_doubt", "gauge", "Pairs neither known to touch nor to be apart.", figures.pairs.in_doubt);
  to.one("fences", "gauge", "Regions, bands about objects, and questions for the nearest.", figures.fences.count);
  to.one("fences_entered", "gauge", "Of them, those that hold something.", figures.fences.entered);
  to.one("fences_cut_short_total", "counter", "Searches of standing questions that ended at their limit.",
         figures.fences.cut_short);
  to.one("fence_events_total", "counter", "Events of standing questions.", figures.fences.events);
  to.one("pair_candidates_total", "counter", "Pairs of movers that the broad phase found.", figures.pairs.candidates);
  to.one("pairs_filtered_total", "counter", "Pairs of movers that layers, masks or groups keep apart.",
         figures.pairs.filtered);
  to.one("pair_tests_total", "counter", "Pairs tested exactly.", figures.pairs.exact_tests);
  to.one("poses_applied_total", "counter", "Poses applied.", figures.poses.applied);
  to.one("poses_late_total", "counter", "Poses that came too late to move anything.", figures.poses.late);
  to.one("poses_lost_total", "counter", "Poses unknown, refused, superseded or dropped.", figures.poses.lost());
  to.one("stamps_late_total", "counter", "Batches whose time is before an earlier one.", figures.stamps.late);
  to.one("requests_refused_total", "counter", "Questions refused.", figures.refused);
  to.one("answers_undecided_total", "counter", "Answers that are neither yes nor no.", figures.undecided);
  to.head("questions_answered_total", "counter", "Questions answered.");
  for (const AskedKind& asked : figures.questions) to.line(asked.answered, "kind=" + label(asked.kind));
  to.head("message_duration_seconds", "histogram", "Duration of answering one message of questions.");
  for (const AskedKind& asked : figures.questions) to.histogram(asked.durations, "kind=" + label(asked.kind));
}

}  // namespace

std::string metrics_text(const std::optional<ServerStatus>& status, const std::optional<Figures>& figures) {
  Writer to;
  to.one("up", "gauge", "1 while the server answers.", status ? 1 : 0);
  if (status) write_status(to, *status);
  if (status && figures) write_figures(to, *figures);
  return to.text;
}

}  // namespace collided::view
