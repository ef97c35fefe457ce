#pragma once

#include <atomic>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "client/view/asker.hpp"
#include "client/view/drawer.hpp"
#include "client/view/foxglove.hpp"
#include "client/view/metrics.hpp"
#include "client/view/page_feed.hpp"
#include "client/view/server_memory.hpp"
#include "client/view/web_server.hpp"

namespace collided::view {

/// Where to serve, for whom, and limits.
struct ViewerOptions {
  WebAddress address{};
  RequestRules rules{};
  WebLimits limits{};
  bool y_is_up = false;
  std::string connection = {};  // options of `collide` for this server, in the commands that the page shows
};

/// Shows a server live in browsers and to programs with Foxglove's protocol. It follows the server as a client, serves
/// the page, and passes the page's questions on. It runs on its own threads until it is destroyed. At an address that
/// other machines reach it answers only requests with its token.
class Viewer {
 public:
  /// client  must outlive it
  /// throws  std::runtime_error with a sentence if it cannot listen at the address
  static Result<std::unique_ptr<Viewer>> start(Client& client, const ViewerOptions& options);
  ~Viewer();
  Viewer(const Viewer&) = delete;
  Viewer& operator=(const Viewer&) = delete;

  std::uint16_t port() const { return web_->port(); }
  const WebCounts& counts() const { return web_->counts(); }
  /// The token of the options, or one made for an address that other machines reach; empty if none is needed.
  const std::string& token() const { return rules_.token; }

 private:
  using Connection = WebServer::Connection;
  /// Passes everything on to both kinds of clients, and keeps the metrics for a third.
  class Both : public Observer {
   public:
    Both(PageFeed& pages, Foxglove& foxglove, Metrics& metrics)
        : pages_(pages), foxglove_(foxglove), metrics_(metrics) {}
    void objects(const std::shared_ptr<const ShownObjects>& shown) override;
    void poses(const Poses& poses) override;
    void status(const ServerStatus& status, const std::optional<Figures>& recent) override;
    void totals(const ServerStatus& status, const std::optional<Figures>& since_start) override;
    void standing(std::span<const draw::StandingOutline> outlines) override;
    void silent(double seconds) override;
    void events(std::span<const Event> events) override;

   private:
    PageFeed& pages_;
    Foxglove& foxglove_;
    Metrics& metrics_;
  };

  Viewer(Client& client, const ViewerOptions& options);
  WebServer::Handlers handlers();
  // The web server's handlers.
  std::optional<WebPage> page(std::string_view target) const;
  UploadAnswer open_recording(const std::string& path) const;
  void open(Connection client, const std::string& protocol);
  void close(Connection client);
  void hear(Connection client, std::string_view message, bool is_text);
  // Sends a new page the full state, and adds it to pages_.
  void greet(Connection page);
  // Has the asker answer a page's question.
  void pass_on(Connection page, std::string_view text);
  void tell_pages(const WebMessage& message);

  const RequestRules rules_;
  const std::string hello_;
  std::map<std::string, WebPage, std::less<>> assets_;
  mutable std::mutex mutex_;
  std::vector<Connection> pages_;
  std::atomic<bool> is_stopping_{false};
  std::atomic<std::size_t> watching_{0};  // connections; poses are fetched only while there are any
  // Destroyed in reverse order: the asker's and the follower's threads use the web server, whose thread uses the feed.
  PageFeed feed_;
  Foxglove foxglove_;
  Metrics metrics_;
  Both both_{feed_, foxglove_, metrics_};
  ServerMemory memory_;
  std::unique_ptr<Drawer> drawer_;
  std::unique_ptr<WebServer> web_;
  std::unique_ptr<Asker> asker_;
  std::unique_ptr<Follower> follower_;
};

}  // namespace collided::view
