#include "client/view/web_server.hpp"

#include <algorithm>
#include <deque>
#include <limits>
#include <map>
#include <stdexcept>
#include <system_error>
#include <thread>
#include <unordered_map>
#include <utility>

#include <boost/asio/dispatch.hpp>
#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/post.hpp>
#include <boost/asio/steady_timer.hpp>
#include <boost/asio/thread_pool.hpp>
#include <boost/beast/core.hpp>
#include <boost/beast/http.hpp>
#include <boost/beast/websocket.hpp>

#include "client/view/uploaded_file.hpp"

namespace collided::view {
namespace {

namespace asio = boost::asio;
namespace beast = boost::beast;
namespace http = beast::http;
namespace websocket = beast::websocket;
using tcp = asio::ip::tcp;
using Clock = std::chrono::steady_clock;
using beast::error_code;

constexpr std::size_t kPieceBytes = 256 << 10;  // that a client must receive or send within the stall time

/// The page runs no scripts from elsewhere, and cannot be embedded in another page.
constexpr std::string_view kContentPolicy =
    "default-src 'none'; script-src 'self'; style-src 'self'; connect-src 'self'; img-src 'self' data:; "
    "frame-ancestors 'none'; base-uri 'none'; form-action 'none'";
std::string_view view_of(beast::string_view text) { return {text.data(), text.size()}; }

std::vector<std::string> list_of(beast::string_view header) {
  std::vector<std::string> words;
  for (const auto& word : http::token_list(header)) words.emplace_back(word);
  return words;
}

}  // namespace

class WebServer::Running {
 public:
  Running(const WebAddress& address, const RequestRules& rules, const WebLimits& limits, Handlers handlers);
  ~Running();

  void start() {
    thread_ = std::thread([this] { run(); });
  }
  std::uint16_t port() const { return port_; }
  const WebCounts& counts() const { return counts_; }
  /// A browser sends the cookies of one host to all of its ports, so each viewer of a machine has a name of its own.
  std::string cookie_name() const { return "collided_view_" + std::to_string(port_); }
  asio::io_context& context() { return context_; }
  void send(Connection to, WebMessage message);

 private:
  class Request;
  class Socket;
  /// Counts as one connection as long as it lives.
  class OpenConnection {
   public:
    explicit OpenConnection(WebCounts& counts) : counts_(&counts) { ++counts_->open; }
    OpenConnection(OpenConnection&& other) noexcept : counts_(std::exchange(other.counts_, nullptr)) {}
    OpenConnection& operator=(OpenConnection&&) = delete;
    ~OpenConnection() {
      if (counts_ != nullptr) --counts_->open;
    }

   private:
    WebCounts* counts_;
  };

  void run();
  void accept();
  void take(tcp::socket socket);
  void close_one_request();
  bool close_one_answer();
  void look_for_stalled();

  const RequestRules rules_;
  const WebLimits limits_;
  const Handlers handlers_;
  WebCounts counts_;
  std::unordered_map<Connection, std::weak_ptr<Socket>> sockets_;
  std::map<std::uint64_t, Request*> reading_;    // without a whole request, the oldest first
  std::map<std::uint64_t, Request*> answering_;  // a page is being sent to these, oldest first
  std::uint64_t newest_turn_ = 0;
  Request* uploading_ = nullptr;  // the one with a file that is received or read
  asio::io_context context_{1};   // owns the connections, which use the members above
  // Writes and reads uploaded files, so that the other connections do not wait for the disk.
  asio::thread_pool files_{1};
  tcp::acceptor acceptor_{context_};
  asio::steady_timer pause_{context_};
  asio::steady_timer tick_{context_};
  std::uint16_t port_ = 0;
  Connection newest_ = 0;
  std::thread thread_;
};

/// A WebSocket connection. It reads no more than the limits allow, and sends as fast as the client receives.
class WebServer::Running::Socket : public std::enable_shared_from_this<Socket> {
 public:
  Socket(Running& owner, OpenConnection place, beast::tcp_stream stream, Connection number)
      : owner_(owner),
        place_(std::move(place)),
        stream_(std::move(stream)),
        number_(number),
        message_(owner.limits_.message_bytes) {}

  ~Socket() {
    if (is_open_) owner_.handlers_.closed(number_);
    owner_.sockets_.erase(number_);
  }

  void open(const http::request<http::empty_body>& request, const std::string& protocol) {
    beast::get_lowest_layer(stream_).expires_never();
    websocket::stream_base::timeout timeout{owner_.limits_.request, owner_.limits_.stall, true};
    stream_.set_option(timeout);
    stream_.set_option(websocket::stream_base::decorator([protocol](websocket::response_type& response) {
      if (!protocol.empty()) response.set(http::field::sec_websocket_protocol, protocol);
    }));
    stream_.read_message_max(owner_.limits_.message_bytes);
    stream_.async_accept(request, [self = shared_from_this(), protocol](error_code failed) {
      if (failed) return;
      self->is_open_ = true;
      self->owner_.handlers_.opened(self->number_, protocol);
      self->read();
    });
  }

  void tell(WebMessage message) {
    if (!is_open_ || is_dropped_) return;
    if (!is_writing_) return write(std::move(message));
    const auto same = std::ranges::find_if(
        waiting_, [&](const WebMessage& one) { return one.lane != 0 && one.lane == message.lane; });
    if (same != waiting_.end()) {
      *same = std::move(message);
      ++owner_.counts_.superseded;
      return;
    }
    // Only messages without a lane accumulate; at most one of each lane waits. The message being written no longer
    // waits, however large.
    if (message.lane == 0) {
      ++piled_messages_;
      piled_bytes_ += message.bytes->size();
      if (piled_messages_ > owner_.limits_.waiting_messages || piled_bytes_ > owner_.limits_.waiting_bytes)
        return drop(owner_.counts_.slow);
    }
    waiting_.push_back(std::move(message));
  }

  void drop_if_stalled(Clock::time_point now) {
    if (is_writing_ && now - taken_at_ > owner_.limits_.stall) drop(owner_.counts_.slow);
  }

 private:
  void read() {
    stream_.async_read(message_, [self = shared_from_this()](error_code failed, std::size_t) {
      if (failed) return self->end(failed);
      if (self->is_dropped_) return;
      if (!self->may_say_more()) return self->drop(self->owner_.counts_.flooding);
      const auto bytes = self->message_.data();
      self->owner_.handlers_.said(self->number_, {static_cast<const char*>(bytes.data()), bytes.size()},
                                  self->stream_.got_text());
      self->message_.consume(self->message_.size());
      self->read();
    });
  }

  bool may_say_more() {
    const Clock::time_point now = Clock::now();
    if (now - second_began_ >= std::chrono::seconds(1)) {
      second_began_ = now;
      said_this_second_ = 0;
    }
    return ++said_this_second_ <= owner_.limits_.messages_a_second;
  }

  void write(WebMessage message) {
    is_writing_ = true;
    written_ = std::move(message);
    written_bytes_ = 0;
    stream_.text(written_.is_text);
    write_piece();
  }

  /// A client that receives a large message slowly is not stalled: each piece has the full stall time.
  void write_piece() {
    taken_at_ = Clock::now();
    const std::string_view rest = std::string_view(*written_.bytes).substr(written_bytes_);
    const std::string_view piece = rest.substr(0, kPieceBytes);
    stream_.async_write_some(piece.size() == rest.size(), asio::buffer(piece),
                             [self = shared_from_this()](error_code failed, std::size_t bytes) {
                               self->written_bytes_ += bytes;
                               const bool is_whole = self->written_bytes_ >= self->written_.bytes->size();
                               if (!failed && !self->is_dropped_ && !is_whole) return self->write_piece();
                               self->is_writing_ = false;
                               self->written_ = {};
                               if (failed || self->is_dropped_) return self->end(failed);
                               self->write_next();
                             });
  }

  void write_next() {
    if (waiting_.empty()) return;
    WebMessage next = std::move(waiting_.front());
    waiting_.pop_front();
    if (next.lane == 0) {
      --piled_messages_;
      piled_bytes_ -= next.bytes->size();
    }
    write(std::move(next));
  }

  void end(error_code failed) {
    const bool is_malformed = failed == websocket::error::message_too_big ||
                              failed == websocket::error::buffer_overflow ||
                              (failed.category() == make_error_code(websocket::error::bad_opcode).category() &&
                               failed != websocket::error::closed);
    if (is_malformed) ++owner_.counts_.malformed;
    close();
  }

  void drop(std::atomic<std::uint64_t>& count) {
    if (!is_dropped_) ++count;
    close();
  }

  /// Closes at once, without a closing handshake, which a client that receives nothing would not answer.
  void close() {
    is_dropped_ = true;
    waiting_.clear();
    beast::get_lowest_layer(stream_).close();
  }

  Running& owner_;
  OpenConnection place_;
  websocket::stream<beast::tcp_stream> stream_;
  const Connection number_;
  beast::flat_buffer message_;
  WebMessage written_;
  std::size_t written_bytes_ = 0;
  std::deque<WebMessage> waiting_;  // behind the one that is being written
  std::size_t piled_messages_ = 0;  // of the waiting ones, those without a lane
  std::size_t piled_bytes_ = 0;
  bool is_open_ = false;
  bool is_dropped_ = false;
  bool is_writing_ = false;
  Clock::time_point taken_at_;  // when the client had received everything written before
  Clock::time_point second_began_;
  std::uint32_t said_this_second_ = 0;
};

/// An HTTP connection, until it becomes a WebSocket.
class WebServer::Running::Request : public std::enable_shared_from_this<Request> {
 public:
  Request(Running& owner, tcp::socket socket)
      : owner_(owner), stream_(std::move(socket)), buffer_(2 * owner.limits_.header_bytes) {
    error_code ignored;
    address_ = stream_.socket().remote_endpoint(ignored).address();
    const auto own = stream_.socket().local_endpoint(ignored).address();
    own_address_ = own.to_string();
    is_loopback_ = own.is_loopback();
  }

  ~Request() {
    end_upload();
    owner_.reading_.erase(turn_);
    owner_.answering_.erase(turn_);
  }

  void read() {
    place_.reset();
    turn_ = ++owner_.newest_turn_;
    owner_.reading_.emplace(turn_, this);
    parser_.emplace();
    parser_->header_limit(owner_.limits_.header_bytes);
    // A body is not read here, and an upload has a limit of its own.
    parser_->body_limit(std::numeric_limits<std::uint64_t>::max());
    stream_.expires_after(is_first_ ? owner_.limits_.first_request : owner_.limits_.request);
    http::async_read_header(stream_, buffer_, *parser_, [self = shared_from_this()](error_code failed, std::size_t) {
      self->owner_.reading_.erase(self->turn_);
      self->is_first_ = false;
      if (failed) return self->refuse(failed);
      self->answer();
    });
  }
  const asio::ip::address& address() const { return address_; }
  void close() { stream_.close(); }
  bool is_slow() const { return Clock::now() - answered_ > owner_.limits_.first_request; }

 private:
  void refuse(error_code failed) {
    const bool is_malformed = failed.category() == make_error_code(http::error::bad_method).category() &&
                              failed != http::error::end_of_stream && failed != http::error::partial_message;
    if (!is_malformed) return;
    ++owner_.counts_.malformed;
    keeps_ = false;
    respond(http::status::bad_request, "text/plain", make_bytes("this is no request that a viewer answers\n"));
  }

  void answer() {
    const http::request<http::empty_body>& request = parser_->get();
    version_ = request.version() == 0 ? 11 : request.version();
    method_ = request.method();
    const bool brings_body = !parser_->is_done();
    if (brings_body && method_ != http::verb::post) return refuse(http::error::body_limit);
    if (owner_.counts_.open >= owner_.limits_.connections && !owner_.close_one_answer()) {
      ++owner_.counts_.full;
      keeps_ = false;
      return respond(http::status::service_unavailable, "text/plain",
                     make_bytes("too many connections to this viewer; later\n"));
    }
    place_.emplace(owner_.counts_);
    keeps_ = request.keep_alive();
    // With two names a proxy may have used the other one (RFC 9112, 3.2).
    if (request.count(http::field::host) > 1) return refuse(http::error::bad_field);
    const std::string_view host = view_of(request[http::field::host]);
    if (!may_be_called(host, own_address_, is_loopback_, owner_.rules_)) {
      return forbid("this viewer is not asked under that name; collide view --host NAME allows one\n");
    }
    if (!may_connect(view_of(request[http::field::origin]), host, owner_.rules_)) {
      return forbid("pages of that origin may not ask this viewer; collide view --origin URL allows one\n");
    }
    const std::string_view target = view_of(request.target());
    switch (admission_of(target, view_of(request[http::field::cookie]), owner_.cookie_name(), owner_.rules_)) {
      case Admission::none:
        return forbid("this viewer shows itself only under the address that collide view printed, with its token\n");
      case Admission::by_query: sets_cookie_ = true; break;
      case Admission::by_cookie: sets_cookie_ = false; break;
    }
    target_ = owner_.rules_.token.empty() ? std::string(target) : without_token(target);
    if (method_ == http::verb::post && !owner_.handlers_.upload_target.empty() &&
        target_ == owner_.handlers_.upload_target) {
      return take_upload(view_of(request[http::field::origin]), host);
    }
    if (brings_body) return refuse(http::error::body_limit);
    if (websocket::is_upgrade(request)) return upgrade(request);
    if (method_ != http::verb::get && method_ != http::verb::head) {
      return respond(http::status::method_not_allowed, "text/plain", make_bytes("only GET\n"));
    }
    const std::optional<WebPage> page = owner_.handlers_.page(target_);
    if (!page) return respond(http::status::not_found, "text/plain", make_bytes("no such page\n"));
    respond(http::status::ok, page->type, page->body);
  }

  /// Begins to receive a file. Pages of other origins that may connect may not send any.
  void take_upload(std::string_view origin, std::string_view host) {
    if (!may_connect(origin, host, {})) return forbid("only this viewer's own pages may send it a file\n");
    keeps_ = false;
    if (parser_->is_done()) return refuse_upload(http::status::bad_request, "no file came with it");
    const auto length = parser_->content_length();
    if (length && *length > owner_.limits_.upload_bytes) return refuse_size();
    if (owner_.uploading_ != nullptr) {
      ++owner_.counts_.full;
      return refuse_upload(http::status::service_unavailable, "this viewer reads another file; try again later");
    }
    try {
      file_ = std::make_unique<UploadedFile>();
    } catch (const std::system_error& failed) {
      return refuse_upload(http::status::insufficient_storage, failed.what());
    }
    owner_.uploading_ = this;
    upload_.emplace(std::move(*parser_));
    piece_.resize(kPieceBytes);
    receive_piece();
  }

  void receive_piece() {
    auto& body = upload_->get().body();
    body.data = piece_.data();
    body.size = piece_.size();
    body.more = true;
    stream_.expires_after(owner_.limits_.stall);
    http::async_read(stream_, buffer_, *upload_, [self = shared_from_this()](error_code failed, std::size_t) {
      if (failed == beast::error::timeout) ++self->owner_.counts_.slow;
      if (failed && failed != http::error::need_buffer) return self->end_upload();
      const std::size_t bytes = self->piece_.size() - self->upload_->get().body().size;
      self->received_bytes_ += bytes;
      if (self->received_bytes_ > self->owner_.limits_.upload_bytes) return self->refuse_size();
      self->keep_piece(bytes);
    });
  }

  /// Writes a piece; then receives the next one, or has the whole file read.
  void keep_piece(std::size_t bytes) {
    on_file_thread(
        [this, bytes]() -> UploadAnswer {
          try {
            file_->append(std::string_view(piece_).substr(0, bytes));
            return {.is_taken = true, .page = {}};
          } catch (const std::system_error& failed) { return {.is_taken = false, .page = sentence(failed.what())}; }
        },
        [this](const UploadAnswer& kept) {
          if (!kept.is_taken) return refuse_upload(http::status::insufficient_storage, *kept.page.body);
          if (!upload_->is_done()) return receive_piece();
          on_file_thread([this] { return answer_of_file(); },
                         [this](const UploadAnswer& answer) {
                           end_upload();
                           const auto status = answer.is_taken ? http::status::ok : http::status::unprocessable_entity;
                           respond(status, answer.page.type, answer.page.body);
                         });
        });
  }

  UploadAnswer answer_of_file() const {
    try {
      return owner_.handlers_.uploaded(file_->path());
    } catch (const std::bad_alloc&) {
      return {.is_taken = false, .page = sentence("this viewer has too little memory for it")};
    } catch (const std::exception& failed) { return {.is_taken = false, .page = sentence(failed.what())}; }
  }

  /// Calls then(work()): work on the thread for files, then on the server's. The connection does nothing meanwhile.
  template <class Work, class Then>
  void on_file_thread(Work work, Then then) {
    asio::post(owner_.files_, [self = shared_from_this(), work, then]() mutable {
      Running& owner = self->owner_;
      // The last owner of a connection must be the server's thread.
      asio::post(owner.context_, [self = std::move(self), then, done = work()] { then(done); });
    });
  }

  void end_upload() {
    if (owner_.uploading_ == this) owner_.uploading_ = nullptr;
    file_.reset();
  }

  static WebPage sentence(std::string text) { return {"text/plain; charset=utf-8", make_bytes(std::move(text))}; }
  void refuse_size() {
    refuse_upload(http::status::payload_too_large, "it is too large: this viewer takes at most " +
                                                       std::to_string(owner_.limits_.upload_bytes >> 20) + " MiB");
  }
  /// Answers before the whole file has arrived. The rest is received too: a connection that is closed with unread bytes
  /// may lose its answer.
  void refuse_upload(http::status status, std::string why) {
    end_upload();
    drains_ = true;
    const WebPage page = sentence(std::move(why));
    respond(status, page.type, page.body);
  }
  void drain() {
    piece_.resize(kPieceBytes);
    stream_.async_read_some(asio::buffer(piece_), [self = shared_from_this()](error_code failed, std::size_t) {
      if (!failed) self->drain();
    });
  }

  void forbid(const char* why) {
    ++owner_.counts_.forbidden;
    keeps_ = false;
    respond(http::status::forbidden, "text/plain", make_bytes(why));
  }

  void upgrade(const http::request<http::empty_body>& request) {
    const std::vector<std::string> offered = list_of(request[http::field::sec_websocket_protocol]);
    const std::optional<std::string> protocol = owner_.handlers_.protocol(target_, offered);
    if (!protocol) {
      keeps_ = false;
      return respond(http::status::not_found, "text/plain", make_bytes("none of these protocols is spoken here\n"));
    }
    // A place is reserved for pages, even if one program holds many connections open.
    const std::size_t most = owner_.limits_.connections - owner_.limits_.connections / 4;
    if (owner_.sockets_.size() >= most) {
      ++owner_.counts_.full;
      keeps_ = false;
      return respond(http::status::service_unavailable, "text/plain", make_bytes("too many watch already\n"));
    }
    const Connection number = ++owner_.newest_;
    const auto socket = std::make_shared<Socket>(owner_, std::move(*place_), std::move(stream_), number);
    owner_.sockets_.emplace(number, socket);
    socket->open(request, *protocol);
  }

  void respond(http::status status, std::string_view type, Bytes body) {
    body_ = std::move(body);
    response_.emplace(status, version_);
    response_->set(http::field::content_type, beast::string_view(type.data(), type.size()));
    response_->set(http::field::cache_control, "no-store");
    response_->set("Content-Security-Policy", beast::string_view(kContentPolicy.data(), kContentPolicy.size()));
    response_->set("Cross-Origin-Resource-Policy", "same-origin");
    response_->set("Referrer-Policy", "no-referrer");
    response_->set("X-Content-Type-Options", "nosniff");
    // The page's further requests, and its socket, then contain the token.
    if (std::exchange(sets_cookie_, false))
      response_->set(http::field::set_cookie,
                     owner_.cookie_name() + '=' + owner_.rules_.token + "; Path=/; HttpOnly; SameSite=Strict");
    response_->keep_alive(keeps_);
    response_->content_length(body_->size());
    if (method_ != http::verb::head) response_->body() = beast::span<const char>(body_->data(), body_->size());
    serializer_.emplace(*response_);
    serializer_->split(method_ == http::verb::head);
    stream_.expires_after(owner_.limits_.response);
    turn_ = ++owner_.newest_turn_;
    answered_ = Clock::now();
    if (place_) owner_.answering_.emplace(turn_, this);
    const auto sent = [self = shared_from_this()](error_code failed, std::size_t) {
      self->owner_.answering_.erase(self->turn_);
      if (failed == beast::error::timeout) ++self->owner_.counts_.slow;
      self->body_.reset();
      if (!failed && self->keeps_) return self->read();
      error_code ignored;
      self->stream_.socket().shutdown(tcp::socket::shutdown_send, ignored);
      if (failed || !self->drains_) return;
      self->stream_.expires_after(self->owner_.limits_.request);
      self->drain();
    };
    if (method_ == http::verb::head) http::async_write_header(stream_, *serializer_, sent);
    else http::async_write(stream_, *serializer_, sent);
  }

  Running& owner_;
  std::optional<OpenConnection> place_;  // while it is answered
  beast::tcp_stream stream_;
  beast::flat_buffer buffer_;
  asio::ip::address address_;   // the client's
  std::uint64_t turn_ = 0;      // since when it is among reading_ or answering_
  Clock::time_point answered_;  // when its answer was begun
  bool is_first_ = true;
  std::string own_address_;
  bool is_loopback_ = false;
  bool keeps_ = false;
  bool sets_cookie_ = false;
  bool drains_ = false;  // remaining data is received after the answer
  unsigned version_ = 11;
  http::verb method_ = http::verb::unknown;
  std::string target_;
  std::optional<http::request_parser<http::empty_body>> parser_;
  // The state of an upload.
  std::optional<http::request_parser<http::buffer_body>> upload_;
  std::unique_ptr<UploadedFile> file_;
  std::string piece_;  // received, and not yet written
  std::uint64_t received_bytes_ = 0;
  std::optional<http::response<http::span_body<const char>>> response_;
  std::optional<http::response_serializer<http::span_body<const char>>> serializer_;
  Bytes body_;
};

WebServer::Running::Running(const WebAddress& address, const RequestRules& rules, const WebLimits& limits,
                            Handlers handlers)
    : rules_(rules), limits_(limits), handlers_(std::move(handlers)) {
  error_code failed;
  const auto where = asio::ip::make_address(address.address, failed);
  if (failed)
    throw std::runtime_error("'" + address.address +
                             "' is no address; one of this machine's is needed, such as 127.0.0.1");
  const tcp::endpoint endpoint(where, address.port);
  acceptor_.open(endpoint.protocol(), failed);
  if (!failed) acceptor_.set_option(asio::socket_base::reuse_address(true), failed);
  if (!failed) acceptor_.bind(endpoint, failed);
  if (!failed) acceptor_.listen(asio::socket_base::max_listen_connections, failed);
  if (failed)
    throw std::runtime_error("port " + std::to_string(address.port) + " of " + address.address + ": " +
                             failed.message());
  port_ = acceptor_.local_endpoint().port();
  accept();
  look_for_stalled();
}

WebServer::Running::~Running() {
  context_.stop();
  if (thread_.joinable()) thread_.join();
  files_.stop();
  files_.join();
}

void WebServer::Running::run() {
  for (;;) {
    try {
      context_.run();
      return;
    } catch (const std::exception&) {
      // The connection whose handler threw is gone with it; the others continue.
      ++counts_.faults;
    }
  }
}

void WebServer::Running::accept() {
  acceptor_.async_accept([this](error_code failed, tcp::socket socket) {
    if (!failed) {
      take(std::move(socket));
      return accept();
    }
    // Usually the process has no file descriptor left: another connection must end first.
    pause_.expires_after(std::chrono::milliseconds(100));
    pause_.async_wait([this](error_code) { accept(); });
  });
}

void WebServer::Running::take(tcp::socket socket) {
  ++counts_.connections;
  if (reading_.size() >= limits_.requests) close_one_request();
  std::make_shared<Request>(*this, std::move(socket))->read();
}

/// Closes the oldest of those from the address with the most: one client's half requests displace each other.
void WebServer::Running::close_one_request() {
  std::map<asio::ip::address, std::size_t> counts;
  for (const auto& [number, request] : reading_) ++counts[request->address()];
  const auto most = std::ranges::max_element(counts, {}, [](const auto& count) { return count.second; });
  const auto oldest =
      std::ranges::find_if(reading_, [&](const auto& entry) { return entry.second->address() == most->first; });
  ++counts_.full;
  oldest->second->close();
  reading_.erase(oldest);
}

/// Closes the answer that was begun first, if its client is slow to receive it: others wait for its place.
bool WebServer::Running::close_one_answer() {
  if (answering_.empty() || !answering_.begin()->second->is_slow()) return false;
  ++counts_.slow;
  answering_.begin()->second->close();
  answering_.erase(answering_.begin());
  return true;
}

void WebServer::Running::look_for_stalled() {
  tick_.expires_after(std::chrono::seconds(1));
  tick_.async_wait([this](error_code failed) {
    if (failed) return;
    std::vector<std::shared_ptr<Socket>> open;
    for (const auto& [number, socket] : sockets_) {
      if (auto alive = socket.lock()) open.push_back(std::move(alive));
    }
    for (const auto& socket : open) socket->drop_if_stalled(Clock::now());
    look_for_stalled();
  });
}

void WebServer::Running::send(Connection to, WebMessage message) {
  const auto found = sockets_.find(to);
  if (found == sockets_.end()) return;
  if (const auto socket = found->second.lock()) socket->tell(std::move(message));
}

WebServer::WebServer(const WebAddress& address, const RequestRules& rules, const WebLimits& limits, Handlers handlers)
    : running_(std::make_unique<Running>(address, rules, limits, std::move(handlers))) {}
WebServer::~WebServer() = default;

void WebServer::start() { running_->start(); }

bool is_loopback(const WebAddress& address) {
  error_code failed;
  const auto parsed = asio::ip::make_address(address.address, failed);
  return !failed && parsed.is_loopback();
}

std::uint16_t WebServer::port() const { return running_->port(); }

const WebCounts& WebServer::counts() const { return running_->counts(); }

void WebServer::send(Connection to, WebMessage message) {
  asio::dispatch(running_->context(), [running = running_.get(), to, message = std::move(message)]() mutable {
    running->send(to, std::move(message));
  });
}

void WebServer::send(const std::vector<Connection>& to, const WebMessage& message) {
  if (to.empty()) return;
  asio::post(running_->context(), [running = running_.get(), to, message] {
    for (const Connection one : to) running->send(one, message);
  });
}

}  // namespace collided::view
