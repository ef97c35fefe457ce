#include <algorithm>
#include <deque>
#include <exception>
#include <optional>
#include <set>
#include <stdexcept>
#include <utility>

#include <nlohmann/json.hpp>

#include "client/library/connection/errors.hpp"
#include "client/library/recordings/recorded_events.hpp"
#include "client/library/recordings/recorded_objects.hpp"
#include "client/library/recordings/recorded_run.hpp"
#include "collided/recording.hpp"

namespace collided {
namespace client {
namespace {

using recording::Recorded;
using std::chrono::nanoseconds;
using TakeChange = std::function<void(const PictureChange&)>;

constexpr std::size_t kMostTables = 2'000;
constexpr nanoseconds kStatusPeriod{500'000'000};

/// Passes on the picture of a recording, item by item.
class PictureReading {
 public:
  PictureReading(const RecordedRun& run, const PictureOptions& options, const TakeChange& take)
      : run_(run), options_(options), take_(take), span_(span_of(run)), objects_(options.surroundings) {
    const nanoseconds length = span_.end - span_.begin;
    table_period_ = std::max(options.table, length / static_cast<std::int64_t>(kMostTables));
    const auto movers = static_cast<std::int64_t>(count_movers());
    const auto most_poses = static_cast<std::int64_t>(std::max<std::size_t>(options.most_poses, 1));
    frame_period_ = std::max(options.frame, nanoseconds(length.count() / most_poses * movers));
  }

  RecordedPicture read() {
    gather_events();
    auto own = run_.own.begin();
    bool is_stopped = false;
    for (std::size_t i = 0; i < run_.items.size() && !is_stopped; ++i) {
      const RecordedItem& item = run_.items[i];
      const nanoseconds now = item.opening ? span_.begin : std::max(span_.begin, nanoseconds(item.log_time));
      if (!item.opening) {
        for (; own != run_.own.end() && nanoseconds(own->log_time) <= now; ++own) pass_on(*own);
        pass_on_events(now);
        if (is_due(frame_at_, frame_period_, now)) show(now);
        is_stopped = options_.go_on && !options_.go_on();
      }
      try {
        hear(i, now);
      } catch (const std::bad_alloc&) { throw; } catch (const std::exception&) {
        ++broken_;
      }
    }
    if (!is_stopped) {
      for (; own != run_.own.end(); ++own) pass_on(*own);
      const nanoseconds end = std::max(span_.begin, span_.end);
      pass_on_events(end);
      table_at_.reset();
      show(end);
    }
    RecordedPicture picture{.length = span_.end - span_.begin, .warnings = run_.warnings};
    if (broken_ > 0) picture.warnings.push_back(std::to_string(broken_) + " samples do not hold; left out");
    if (missing_.lost > 0) picture.warnings.push_back(std::to_string(missing_.lost) + " events are not in it");
    return picture;
  }

 private:
  static bool is_due(std::optional<nanoseconds> last, nanoseconds period, nanoseconds now) {
    return !last || now - *last >= period;
  }

  std::size_t count_movers() {
    std::set<std::pair<std::uint64_t, std::uint32_t>> defined;
    for (const RecordedItem& item : run_.items) {
      if (item.topic == Recorded::object && wire::read_cdr(item.data, definition_) && definition_->moving)
        defined.emplace(definition_->publisher, definition_->object_number);
    }
    return defined.size() + run_.carried_out.size();
  }

  void gather_events() {
    Names names;
    nanoseconds now = span_.begin;
    WatchState watch([&](const Event& event) {
      Event& kept = events_.emplace_back(std::max(now, span_.begin), event).second;
      kept.a_id = objects_.id_of(kept.a);
      kept.b_id = objects_.id_of(kept.b);
    });
    missing_ = hear_recording(run_, names, watch, [&](nanoseconds time) { now = time; });
  }

  void pass_on_events(nanoseconds until) {
    while (!events_.empty() && events_.front().first <= until) {
      const nanoseconds at = events_.front().first;
      std::vector<Event> together;
      for (; !events_.empty() && events_.front().first == at; events_.pop_front())
        together.push_back(std::move(events_.front().second));
      pass_on(at, std::move(together));
    }
  }
  void pass_on(const RecordedOwnMessage& own) {
    const std::string_view text(reinterpret_cast<const char*>(own.data.data()), own.data.size());
    pass_on(std::max(span_.begin, nanoseconds(own.log_time)), OwnMessage{own.schema_name, std::string(text)});
  }
  template <class What>
  void pass_on(nanoseconds at, What what) {
    take_({.at = at - span_.begin, .what = std::move(what)});
  }

  void hear(std::size_t index, nanoseconds now) {
    const RecordedItem& item = run_.items[index];
    if (item.topic == Recorded::object && wire::read_cdr(item.data, definition_)) objects_.define(*definition_);
    if (item.topic == Recorded::pose && wire::read_cdr(item.data, batch_)) objects_.place(*batch_);
    if (item.topic == Recorded::status && wire::read_cdr(item.data, status_)) take_status(now);
    const auto carried_out = run_.carried_out.find(index);
    if (carried_out == run_.carried_out.end()) return;
    if (!wire::read_cdr(run_.items[carried_out->second.query].data, query_)) return;
    const auto parsed = [](std::string_view text) { return nlohmann::json::parse(text, nullptr, false); };
    objects_.carry_out(parsed(query_->text), dds::view(query_->blob), parsed(carried_out->second.answer));
  }

  void take_status(nanoseconds now) {
    objects_.lose_lost(*status_);
    if (!is_due(status_at_, kStatusPeriod, now)) return;
    status_at_ = now;
    pass_on(now, decode_status(*status_));
  }

  /// Shows the changes. Definitions come one by one, so a table for each would be far too many.
  void show(nanoseconds now) {
    if (objects_.has_new_table() && is_due(table_at_, table_period_, now)) {
      table_at_ = now;
      has_shown_table_ = true;
      pass_on(now, objects_.table());
    }
    if (!objects_.has_new_poses() || !has_shown_table_) return;
    frame_at_ = now;
    pass_on(now, objects_.poses());
  }

  const RecordedRun& run_;
  const PictureOptions& options_;
  const TakeChange& take_;
  const RecordedSpan span_;
  RecordedObjects objects_;
  nanoseconds table_period_{0};
  nanoseconds frame_period_{0};
  bool has_shown_table_ = false;  // poses refer to the objects of a table
  std::optional<nanoseconds> table_at_;
  std::optional<nanoseconds> frame_at_;
  std::optional<nanoseconds> status_at_;
  std::deque<std::pair<nanoseconds, Event>> events_;
  MissingEvents missing_;
  std::uint64_t broken_ = 0;
  dds::Sample<wire::Definition> definition_;
  dds::Sample<wire::PoseBatch> batch_;
  dds::Sample<wire::Status> status_;
  dds::Sample<wire::Query> query_;
};

}  // namespace
}  // namespace client

Result<RecordedPicture> recorded_picture(const std::string& path, const PictureOptions& options,
                                         const std::function<void(const PictureChange&)>& take) try {
  const client::RecordedRun run = client::read_run(client::read_recording(path), path, "Nothing is shown");
  return client::PictureReading(run, options, take).read();
} catch (const std::runtime_error& failed) { return client::bad_input(failed.what(), ""); }

}  // namespace collided
