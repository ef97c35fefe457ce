#include <gtest/gtest.h>

#include "client/view/web_server.hpp"
#include "tests/view/loud_client.hpp"

namespace collided::view {
namespace {

// Also where the request is none at all and has no version.
TEST(WebVersion, AnAnswerIsOfTheVersionThatItsRequestIsOf) {
  WebServer::Handlers handlers;
  handlers.page = [](std::string_view) -> std::optional<WebPage> { return WebPage{"text/html", make_bytes("a page")}; };
  handlers.protocol = [](std::string_view, const std::vector<std::string>&) -> std::optional<std::string> {
    return std::nullopt;
  };
  handlers.opened = [](WebServer::Connection, const std::string&) {};
  handlers.said = [](WebServer::Connection, std::string_view, bool) {};
  handlers.closed = [](WebServer::Connection) {};
  WebServer server(WebAddress{}, {}, {}, std::move(handlers));
  server.start();
  const auto answer = [&](const std::string& request) {
    const test::LoudClient client(server.port());
    EXPECT_TRUE(client.send(request));
    return client.read_until("\r\n\r\n").substr(0, 12);
  };
  const std::string host = "Host: 127.0.0.1:" + std::to_string(server.port()) + "\r\n\r\n";
  EXPECT_EQ(answer("GET / HTTP/1.1\r\n" + host), "HTTP/1.1 200");
  EXPECT_EQ(answer("GET / HTTP/1.0\r\n" + host), "HTTP/1.0 200");
  EXPECT_EQ(answer("\x16\x03\x01\r\n\r\n"), "HTTP/1.1 400");
}

}  // namespace
}  // namespace collided::view
