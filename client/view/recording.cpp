#include "client/view/recording.hpp"

#include <algorithm>
#include <span>
#include <thread>
#include <utility>
#include <variant>
#include <vector>

#include <nlohmann/json.hpp>

#include "client/view/assets.hpp"
#include "client/view/json_text.hpp"
#include "client/view/page_messages.hpp"
#include "client/view/run_writer.hpp"
#include "client/view/standing_recorder.hpp"
#include "collided/recording.hpp"

namespace collided::view {
namespace {

using Clock = std::chrono::steady_clock;

/// JSON in which nothing can end or begin an HTML element. Names may contain anything, and the text is put into a
/// script element.
std::string without_elements(std::string_view json_text) {
  std::string text;
  for (const char c : json_text) c == '<' ? text += "\\u003c" : text += c;
  return text;
}

void replace(std::string& text, std::string_view what, std::string_view with) {
  const std::size_t at = text.find(what);
  if (at != std::string::npos) text.replace(at, what.size(), with);
}

std::string_view asset(std::string_view path) {
  for (const Asset& one : assets()) {
    if (one.path == path) return one.text;
  }
  return {};
}

std::string page_of_run(std::string_view run) {
  std::string page(asset("/"));
  replace(page, R"(<link rel="stylesheet" href="view.css">)",
          "<style>\n" + std::string(asset("/view.css")) + "</style>");
  replace(page, R"(<script src="view.js"></script>)",
          R"(<script type="application/json" id="run">)" + without_elements(run) + "</script>\n<script>\n" +
              std::string(asset("/view.js")) + "</script>");
  return page;
}

/// Passes the content of a recording to a writer, as a Follower does with a server's state.
class ShowToWriter {
 public:
  explicit ShowToWriter(RunWriter& writer) : writer_(writer) {}

  void operator()(const std::shared_ptr<const ShownObjects>& shown) { writer_.observer().objects(shown); }
  void operator()(const Poses& poses) { writer_.observer().poses(poses); }
  void operator()(const ServerStatus& status) { writer_.observer().status(status, {}); }
  /// Contacts open at the beginning are a state, as for a page that has just connected, not events.
  void operator()(std::span<const Event> events) {
    const auto is_open = [](const Event& event) { return event.kind == EventKind::open; };
    const auto first = has_contacts_ ? events.begin() : std::ranges::find_if_not(events, is_open);
    const std::span<const Event> held(events.begin(), first);
    if (!has_contacts_) writer_.add(contacts_text(held, held.size()));
    has_contacts_ = true;
    if (first != events.end()) writer_.observer().events({first, events.end()});
  }
  void operator()(const OwnMessage& own) {
    if (own.schema_name != kStandingSchemaName) return;
    const nlohmann::json message = nlohmann::json::parse(own.data, nullptr, false);
    if (message.is_object() && message.value("type", nlohmann::json()) == "standing") writer_.add(text_of(message));
  }

 private:
  RunWriter& writer_;
  bool has_contacts_ = false;
};

/// A sentence about a file without the file's path, which the page does not know.
std::string about_it(std::string_view sentence, const std::string& path) {
  if (sentence.starts_with(path + ": ")) sentence.remove_prefix(path.size() + 2);
  return std::string(sentence);
}

}  // namespace

Result<SavedRun> record_run(Client& client, const RecordingOptions& options) {
  const Clock::time_point begin = Clock::now();
  const auto now = [begin] { return std::chrono::duration<double>(Clock::now() - begin).count(); };
  RunWriter writer(options.most_bytes, now);
  writer.add(hello_text(options.y_is_up, options.connection));
  FollowOptions follow;
  follow.is_watched = [] { return true; };
  Result<std::unique_ptr<Follower>> follower = Follower::start(client, writer.observer(), follow);
  if (!follower) return follower.error();
  const Clock::time_point end = Clock::now() + options.length;
  constexpr std::chrono::milliseconds kLook{50};
  while (Clock::now() < end && !options.is_stopped() && !writer.is_full()) std::this_thread::sleep_for(kLook);
  follower->reset();
  const double seconds = now();
  return SavedRun{.page = page_of_run(writer.finish(seconds, {})),
                  .seconds = seconds,
                  .frames = writer.frame_count(),
                  .is_full = writer.is_full()};
}

Result<std::string> run_of_recording(const std::string& path, std::shared_ptr<const ShownObjects> surroundings,
                                     const std::function<bool()>& is_stopped) {
  double now_s = 0;
  RunWriter writer(kMostRunBytes, [&] { return now_s; });
  const PictureOptions options{.surroundings = std::move(surroundings),
                               .go_on = [&] { return !is_stopped() && !writer.is_full(); }};
  ShowToWriter show(writer);
  const Result<RecordedPicture> picture = recorded_picture(path, options, [&](const PictureChange& change) {
    now_s = seconds(change.at);
    std::visit(show, change.what);
  });
  if (!picture) {
    Error error = picture.error();
    error.message = about_it(error.message, path);
    return error;
  }
  if (writer.frame_count() == 0) return Error{ErrorCode::bad_input, "nothing in it has a place", ""};
  std::vector<std::string> notes;
  for (const std::string& warning : picture->warnings) notes.push_back(about_it(warning, path));
  if (writer.is_full()) notes.push_back("it is too long; what comes after " + std::to_string(now_s) + " s is left out");
  return writer.finish(writer.is_full() ? now_s : seconds(picture->length), notes);
}

}  // namespace collided::view
