#include "idl/etcd/http_poster.hpp"

#include <chrono>
#include <optional>
#include <utility>

#include <boost/asio/connect.hpp>
#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/beast/core.hpp>
#include <boost/beast/http.hpp>

namespace collided::etcd {
namespace {

namespace asio = boost::asio;
namespace beast = boost::beast;
namespace http = beast::http;
using tcp = asio::ip::tcp;
using beast::error_code;

std::string host_header(const EtcdEndpoint& to) {
  const bool is_address_6 = to.host.find(':') != std::string::npos;
  return (is_address_6 ? "[" + to.host + "]" : to.host) + ":" + to.port;
}

/// One request and its answer. Lives as long as anything of it is under way, which may be longer than anybody waits: a
/// name that is being looked up cannot be stopped.
class HttpExchange : public std::enable_shared_from_this<HttpExchange> {
 public:
  HttpExchange(asio::io_context& io, const EtcdEndpoint& to, const std::string& target, std::string body)
      : resolver_(io), stream_(io), request_(http::verb::post, target, 11, std::move(body)) {
    request_.set(http::field::host, host_header(to));
    request_.set(http::field::content_type, "application/json");
    request_.keep_alive(false);
    request_.prepare_payload();
    parser_.body_limit(HttpPoster::kMostBodyBytes);
    parser_.get().body().max_size(HttpPoster::kMostBodyBytes);
  }

  void start(const EtcdEndpoint& to) {
    error_code is_name;
    const auto address = asio::ip::make_address(to.host, is_name);
    if (!is_name) {
      const auto port = static_cast<std::uint16_t>(std::stoul(to.port));
      return stream_.async_connect(tcp::endpoint(address, port),
                                   [self = shared_from_this()](error_code fault) { self->connected(fault); });
    }
    resolver_.async_resolve(to.host, to.port,
                            [self = shared_from_this()](error_code fault, const tcp::resolver::results_type& found) {
                              if (fault || self->is_over_) return self->end("its name is not known: ", fault);
                              self->stream_.async_connect(
                                  found, [self](error_code failed, const tcp::endpoint&) { self->connected(failed); });
                            });
  }

  void give_up() {
    is_over_ = true;
    resolver_.cancel();
    stream_.close();
  }
  bool is_over() const { return is_over_; }
  const std::string& problem() const { return problem_; }
  HttpAnswer take_answer() {
    return {.status = parser_.get().result_int(), .body = beast::buffers_to_string(parser_.get().body().data())};
  }

 private:
  void connected(error_code fault) {
    if (fault) return end("", fault);
    http::async_write(stream_, request_, [self = shared_from_this()](error_code failed, std::size_t) {
      if (failed) return self->end("while asking: ", failed);
      http::async_read(self->stream_, self->buffer_, self->parser_,
                       [self](error_code broken, std::size_t) { self->end("its answer: ", broken); });
    });
  }
  void end(const char* where, error_code fault) {
    if (is_over_) return;
    if (fault) problem_ = where + fault.message();
    give_up();
  }

  tcp::resolver resolver_;
  beast::tcp_stream stream_;
  beast::flat_buffer buffer_{2 * HttpPoster::kMostBodyBytes};
  http::request<http::string_body> request_;
  // A text would take as much memory at once as the other side says that it will send.
  http::response_parser<http::basic_dynamic_body<beast::flat_buffer>> parser_;
  bool is_over_ = false;
  std::string problem_;
};

}  // namespace

struct HttpContext {
  asio::io_context io;
};

HttpPoster::HttpPoster() : context_(std::make_unique<HttpContext>()) {}
HttpPoster::~HttpPoster() = default;

HttpAnswer HttpPoster::post(const EtcdEndpoint& to, const std::string& target, std::string body,
                            std::int64_t patience_ns) {
  const auto until = std::chrono::steady_clock::now() + std::chrono::nanoseconds(patience_ns);
  const auto exchange = std::make_shared<HttpExchange>(context_->io, to, target, std::move(body));
  context_->io.restart();
  exchange->start(to);
  while (!exchange->is_over() && context_->io.run_one_until(until) > 0) {}
  if (!exchange->is_over()) {
    exchange->give_up();
    throw HttpError("no answer within " + std::to_string(patience_ns / 1'000'000) + " ms");
  }
  if (!exchange->problem().empty()) throw HttpError(exchange->problem());
  return exchange->take_answer();
}

}  // namespace collided::etcd
