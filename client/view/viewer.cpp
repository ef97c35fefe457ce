#include "client/view/viewer.hpp"

#include <algorithm>

#include "client/view/assets.hpp"
#include "client/view/page_answers.hpp"
#include "client/view/page_messages.hpp"
#include "client/view/recording.hpp"

namespace collided::view {
namespace {

constexpr std::string_view kLive = "/live";
constexpr std::string_view kMetrics = "/metrics";
constexpr std::string_view kMemory = "/memory";
constexpr const char* kRecording = "/recording";
constexpr std::string_view kDrawing = "/drawing.svg";

RequestRules rules_of(const ViewerOptions& options) {
  RequestRules rules = options.rules;
  if (rules.token.empty() && !is_loopback(options.address)) rules.token = new_token();
  return rules;
}

}  // namespace

Result<std::unique_ptr<Viewer>> Viewer::start(Client& client, const ViewerOptions& options) {
  std::unique_ptr<Viewer> viewer(new Viewer(client, options));
  FollowOptions follow;
  follow.is_watched = [raw = viewer.get()] { return raw->watching_.load() > 0; };
  Result<std::unique_ptr<Follower>> follower = Follower::start(client, viewer->both_, follow);
  if (!follower) return follower.error();
  viewer->follower_ = std::move(*follower);
  viewer->web_->start();
  return viewer;
}

Viewer::Viewer(Client& client, const ViewerOptions& options)
    : rules_(rules_of(options)),
      hello_(hello_text(options.y_is_up, options.connection)),
      feed_([this](const WebMessage& message) { tell_pages(message); }),
      foxglove_([this](Connection to, const WebMessage& message) { web_->send(to, message); }) {
  for (const Asset& asset : assets())
    assets_[std::string(asset.path)] = {asset.type, make_bytes(std::string(asset.text))};
  asker_ = std::make_unique<Asker>(client, memory_, feed_);
  drawer_ = std::make_unique<Drawer>(client, options.y_is_up);
  web_ = std::make_unique<WebServer>(options.address, rules_, options.limits, handlers());
}

Viewer::~Viewer() {
  is_stopping_ = true;
  // Callers are destroyed before their callees.
  follower_.reset();
  asker_.reset();
  web_.reset();
}

WebServer::Handlers Viewer::handlers() {
  return {
      .page = [this](std::string_view target) { return page(target); },
      .protocol = [](std::string_view target, const std::vector<std::string>& offered) -> std::optional<std::string> {
        if (target == kLive) return std::string();
        return Foxglove::protocol(offered);
      },
      .opened = [this](Connection client, const std::string& protocol) { open(client, protocol); },
      .said = [this](Connection client, std::string_view message, bool is_text) { hear(client, message, is_text); },
      .closed = [this](Connection client) { close(client); },
      .upload_target = kRecording,
      .uploaded = [this](const std::string& path) { return open_recording(path); }};
}

std::optional<WebPage> Viewer::page(std::string_view target) const {
  const auto found = assets_.find(target);
  if (found != assets_.end()) return found->second;
  if (target == kMetrics) return WebPage{"text/plain; version=0.0.4", make_bytes(metrics_.text())};
  if (target.starts_with(kMemory)) return memory_.page(target);
  if (!target.starts_with(kDrawing)) return feed_.page(target);
  Bytes drawing = drawer_->newest();
  return drawing ? std::optional(WebPage{"image/svg+xml", std::move(drawing)}) : std::nullopt;
}

/// Reads a recording that a page has sent.
UploadAnswer Viewer::open_recording(const std::string& path) const {
  Result<std::string> run = run_of_recording(path, feed_.shown(), [this] { return is_stopping_.load(); });
  if (run) return {.is_taken = true, .page = {"application/json", make_bytes(std::move(*run))}};
  return {.is_taken = false, .page = {"text/plain; charset=utf-8", make_bytes(run.error().message)}};
}

/// Opens a connection. Pages use no named protocol; an empty name means a page.
void Viewer::open(Connection client, const std::string& protocol) {
  protocol.empty() ? greet(client) : foxglove_.opened(client);
  ++watching_;
}

void Viewer::close(Connection client) {
  --watching_;
  foxglove_.closed(client);
  const std::lock_guard lock(mutex_);
  std::erase(pages_, client);
}

void Viewer::hear(Connection client, std::string_view message, bool is_text) {
  const auto is_page = [&] {
    const std::lock_guard lock(mutex_);
    return std::find(pages_.begin(), pages_.end(), client) != pages_.end();
  };
  if (!is_page()) foxglove_.said(client, message, is_text);
  else if (is_text) pass_on(client, message);
}

void Viewer::greet(Connection page) {
  web_->send(page, {.bytes = make_bytes(hello_), .is_text = true, .lane = 0});
  {
    const std::lock_guard lock(mutex_);
    pages_.push_back(page);
  }
  // The page is already in the list, so it may get a change twice, which does no harm, but never misses one.
  for (const WebMessage& message : feed_.first_words()) web_->send(page, message);
}

void Viewer::pass_on(Connection page, std::string_view text) {
  const auto tell = [this, page](std::string answer) {
    web_->send(page, {.bytes = make_bytes(std::move(answer)), .is_text = true, .lane = 0});
  };
  std::optional<PageQuestion> question = parse_page_question(text);
  if (!question) return tell(refused_text(0, "this is no question that a viewer passes on"));
  const double id = question->id;
  if (!asker_->ask(std::move(*question), tell)) tell(refused_text(id, "too many questions wait already"));
}

void Viewer::tell_pages(const WebMessage& message) {
  std::vector<Connection> pages;
  {
    const std::lock_guard lock(mutex_);
    pages = pages_;
  }
  web_->send(pages, message);
}

void Viewer::Both::objects(const std::shared_ptr<const ShownObjects>& shown) {
  pages_.objects(shown);
  foxglove_.objects(shown);
}
void Viewer::Both::poses(const Poses& poses) {
  pages_.poses(poses);
  foxglove_.poses(poses);
}
void Viewer::Both::status(const ServerStatus& status, const std::optional<Figures>& recent) {
  pages_.status(status, recent);
  foxglove_.status(status, recent);
}
void Viewer::Both::totals(const ServerStatus& status, const std::optional<Figures>& since_start) {
  metrics_.set(metrics_text(status, since_start));
}
void Viewer::Both::standing(std::span<const draw::StandingOutline> outlines) {
  pages_.standing(outlines);
  foxglove_.standing(outlines);
}
void Viewer::Both::silent(double seconds) {
  metrics_.set(metrics_text({}, {}));
  pages_.silent(seconds);
  foxglove_.silent(seconds);
}
void Viewer::Both::events(std::span<const Event> events) {
  pages_.events(events);
  foxglove_.events(events);
}

}  // namespace collided::view
