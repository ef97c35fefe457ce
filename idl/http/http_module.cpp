// The module collided-http.so, the only thing that links libcurl.
#include <curl/curl.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <memory>
#include <string>
#include <string_view>
#include <system_error>

#include "idl/http/http_post.hpp"

namespace collided::http {
namespace {

constexpr long kOk = 200;
using Multi = std::unique_ptr<CURLM, decltype(&curl_multi_cleanup)>;
using Easy = std::unique_ptr<CURL, decltype(&curl_easy_cleanup)>;
using Headers = std::unique_ptr<curl_slist, decltype(&curl_slist_free_all)>;

bool is_web_address(const std::string& url) {
  const std::unique_ptr<CURLU, decltype(&curl_url_cleanup)> parts(curl_url(), curl_url_cleanup);
  return (url.starts_with("http://") || url.starts_with("https://")) &&
         curl_url_set(parts.get(), CURLUPART_URL, url.c_str(), 0) == CURLUE_OK;
}

/// A post under way.
struct Request {
  const HttpPost& what;
  HttpAnswer& answer;
  CURL* curl;
  std::string line = {};  // of a stream: what has come of it

  /// False ends the transfer.
  bool take(std::string_view bytes) {
    long status = 0;
    curl_easy_getinfo(curl, CURLINFO_RESPONSE_CODE, &status);
    if (what.is_web) return true;
    if (!what.take_line || status != kOk) {
      if (answer.body.size() + bytes.size() > kMostHttpBodyBytes) return false;
      answer.body += bytes;
      return true;
    }
    for (std::size_t end = bytes.find('\n'); end != bytes.npos; end = bytes.find('\n')) {
      line += bytes.substr(0, end);
      bytes.remove_prefix(end + 1);
      what.take_line(line);
      line.clear();
    }
    line += bytes;
    return line.size() <= kMostHttpLineBytes;
  }
};

/// libcurl ends a transfer of which not all is taken.
std::size_t take(char* bytes, std::size_t, std::size_t count, void* request) {
  return static_cast<Request*>(request)->take({bytes, count}) ? count : 0;
}

void note_problem(CURLcode code, CURL* request, std::string_view detail, long patience_ms, HttpAnswer& answer) {
  constexpr std::string_view kCertificate = "SSL certificate problem: ";
  const std::string text(detail.empty() ? curl_easy_strerror(code) : detail);
  answer.fault = HttpFault::unanswered;
  switch (code) {
    case CURLE_OPERATION_TIMEDOUT: answer.problem = "no answer within " + std::to_string(patience_ms) + " ms"; return;
    case CURLE_COULDNT_RESOLVE_HOST: answer.problem = "its name is not known"; return;
    case CURLE_COULDNT_CONNECT: {
      long fault = 0;
      curl_easy_getinfo(request, CURLINFO_OS_ERRNO, &fault);
      answer.problem = std::generic_category().message(fault == 0 ? ECONNREFUSED : static_cast<int>(fault));
      return;
    }
    case CURLE_PEER_FAILED_VERIFICATION:
      answer.fault = HttpFault::not_trusted;
      answer.problem = "its certificate is not accepted: " +
                       (text.starts_with(kCertificate) ? text.substr(kCertificate.size()) : text);
      return;
    case CURLE_SSL_CERTPROBLEM:
    case CURLE_SSL_CACERT_BADFILE:
      answer.fault = HttpFault::unusable_files;
      answer.problem = text;
      return;
    case CURLE_GOT_NOTHING:
    case CURLE_SEND_ERROR:
    case CURLE_RECV_ERROR:
    case CURLE_SSL_CONNECT_ERROR: answer.fault = HttpFault::closed; break;
    default: break;
  }
  answer.problem = "its answer: " + text;
}

class CurlConnection final : public HttpConnection {
 public:
  HttpAnswer post(const HttpPost& what) override {
    HttpAnswer answer;
    if (!multi_ || !easy_) {
      answer = {.problem = "libcurl cannot be used", .fault = HttpFault::unanswered};
      return answer;
    }
    Request request{.what = what, .answer = answer, .curl = easy_.get()};
    const long patience_ms = std::max<long>(1, static_cast<long>(what.patience_ns / 1'000'000));
    std::array<char, CURL_ERROR_SIZE> detail{};
    const Headers headers = set_up(request, patience_ms, detail.data());
    const CURLcode code = perform(what);
    if (code == CURLE_OK) curl_easy_getinfo(easy_.get(), CURLINFO_RESPONSE_CODE, &answer.status);
    else note_problem(code, easy_.get(), detail.data(), patience_ms, answer);
    return answer;
  }

 private:
  Headers set_up(Request& request, long patience_ms, char* detail) {
    const HttpPost& what = request.what;
    CURL* const curl = easy_.get();
    curl_easy_reset(curl);
    // Without "Expect" libcurl would wait for the other side before it sends a long body.
    curl_slist* headers = curl_slist_append(nullptr, "Content-Type: application/json");
    headers = curl_slist_append(headers, "Expect:");
    if (!what.authorization.empty())
      headers = curl_slist_append(headers, ("Authorization: " + what.authorization).c_str());
    curl_easy_setopt(curl, CURLOPT_URL, what.url.c_str());
    curl_easy_setopt(curl, CURLOPT_PROTOCOLS_STR, "http,https");
    curl_easy_setopt(curl, CURLOPT_SSLVERSION, CURL_SSLVERSION_TLSv1_2);
    const auto set_file = [&](CURLoption option, const std::string& file) {
      if (!file.empty()) curl_easy_setopt(curl, option, file.c_str());
    };
    set_file(CURLOPT_CAINFO, what.tls.trusted);
    set_file(CURLOPT_SSLCERT, what.tls.certificate);
    set_file(CURLOPT_SSLKEY, what.tls.key);
    if (!what.is_web) curl_easy_setopt(curl, CURLOPT_PROXY, "");
    curl_easy_setopt(curl, CURLOPT_HTTPHEADER, headers);
    curl_easy_setopt(curl, CURLOPT_POSTFIELDS, what.body.data());
    curl_easy_setopt(curl, CURLOPT_POSTFIELDSIZE_LARGE, static_cast<curl_off_t>(what.body.size()));
    curl_easy_setopt(curl, CURLOPT_WRITEFUNCTION, &take);
    curl_easy_setopt(curl, CURLOPT_WRITEDATA, &request);
    curl_easy_setopt(curl, CURLOPT_ERRORBUFFER, detail);
    curl_easy_setopt(curl, CURLOPT_TIMEOUT_MS, patience_ms);
    if (what.connect_ns != 0)
      curl_easy_setopt(curl, CURLOPT_CONNECTTIMEOUT_MS,
                       std::max<long>(1, static_cast<long>(what.connect_ns / 1'000'000)));
    curl_easy_setopt(curl, CURLOPT_NOSIGNAL, 1L);
    curl_easy_setopt(curl, CURLOPT_QUICK_EXIT, 1L);  // a name that is being looked up cannot be stopped
    return {headers, curl_slist_free_all};
  }

  CURLcode perform(const HttpPost& what) {
    constexpr int kLookMs = 100;
    curl_multi_add_handle(multi_.get(), easy_.get());
    CURLcode code = CURLE_ABORTED_BY_CALLBACK;
    for (int running = 1; running != 0 && !(what.is_over && what.is_over());) {
      if (curl_multi_perform(multi_.get(), &running) != CURLM_OK) break;
      if (running != 0) curl_multi_poll(multi_.get(), nullptr, 0, kLookMs, nullptr);
    }
    int left = 0;
    while (const CURLMsg* done = curl_multi_info_read(multi_.get(), &left)) {
      if (done->msg == CURLMSG_DONE) code = done->data.result;
    }
    curl_multi_remove_handle(multi_.get(), easy_.get());
    return code;
  }

  const Multi multi_{curl_multi_init(), curl_multi_cleanup};
  const Easy easy_{curl_easy_init(), curl_easy_cleanup};
};

std::unique_ptr<HttpConnection> connect() { return std::make_unique<CurlConnection>(); }

}  // namespace
}  // namespace collided::http

extern "C" __attribute__((visibility("default"))) const collided::http::HttpModule& collided_http_module() {
  // Before its threads use it.
  static const CURLcode set_up = curl_global_init(CURL_GLOBAL_DEFAULT);
  static_cast<void>(set_up);
  static constexpr collided::http::HttpModule kModule{.is_web_address = collided::http::is_web_address,
                                                      .connect = collided::http::connect};
  return kModule;
}
