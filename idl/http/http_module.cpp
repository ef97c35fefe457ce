// The module collided-http.so, the only thing that links libcurl.
#include <curl/curl.h>

#include <algorithm>
#include <cerrno>
#include <memory>
#include <system_error>

#include "idl/http/http_post.hpp"

namespace collided::http {
namespace {

bool is_web_address(const std::string& url) {
  const std::unique_ptr<CURLU, decltype(&curl_url_cleanup)> parts(curl_url(), curl_url_cleanup);
  return (url.starts_with("http://") || url.starts_with("https://")) &&
         curl_url_set(parts.get(), CURLUPART_URL, url.c_str(), 0) == CURLUE_OK;
}

/// libcurl ends a transfer of which not all is taken.
std::size_t take(char* bytes, std::size_t, std::size_t count, void* to) {
  std::string& body = *static_cast<std::string*>(to);
  if (body.size() + count > kMostHttpBodyBytes) return 0;
  body.append(bytes, count);
  return count;
}

std::size_t ignore(char*, std::size_t, std::size_t count, void*) { return count; }

int stops(void* asked, curl_off_t, curl_off_t, curl_off_t, curl_off_t) {
  return static_cast<const HttpPost*>(asked)->is_over() ? 1 : 0;
}

std::string problem_of(CURLcode code, CURL* request, long patience_ms) {
  if (code == CURLE_OPERATION_TIMEDOUT) return "no answer within " + std::to_string(patience_ms) + " ms";
  if (code == CURLE_COULDNT_RESOLVE_HOST) return "its name is not known";
  if (code != CURLE_COULDNT_CONNECT) return std::string("its answer: ") + curl_easy_strerror(code);
  long fault = 0;
  curl_easy_getinfo(request, CURLINFO_OS_ERRNO, &fault);
  return std::generic_category().message(fault == 0 ? ECONNREFUSED : static_cast<int>(fault));
}

void post(const HttpPost& what, HttpAnswer& answer) {
  const std::unique_ptr<CURL, decltype(&curl_easy_cleanup)> request(curl_easy_init(), curl_easy_cleanup);
  // Without "Expect" libcurl would wait for the other side before it sends a long body.
  curl_slist* headers = curl_slist_append(nullptr, "Content-Type: application/json");
  headers = curl_slist_append(headers, "Expect:");
  const std::unique_ptr<curl_slist, decltype(&curl_slist_free_all)> held(headers, curl_slist_free_all);
  if (!request || !headers) {
    answer.problem = "libcurl cannot be used";
    return;
  }
  const long patience_ms = std::max<long>(1, static_cast<long>(what.patience_ns / 1'000'000));
  curl_easy_setopt(request.get(), CURLOPT_URL, what.url.c_str());
  curl_easy_setopt(request.get(), CURLOPT_PROTOCOLS_STR, what.is_web ? "http,https" : "http");
  if (!what.is_web) curl_easy_setopt(request.get(), CURLOPT_PROXY, "");
  curl_easy_setopt(request.get(), CURLOPT_HTTPHEADER, headers);
  curl_easy_setopt(request.get(), CURLOPT_POSTFIELDS, what.body.data());
  curl_easy_setopt(request.get(), CURLOPT_POSTFIELDSIZE_LARGE, static_cast<curl_off_t>(what.body.size()));
  curl_easy_setopt(request.get(), CURLOPT_WRITEFUNCTION, what.is_web ? &ignore : &take);
  curl_easy_setopt(request.get(), CURLOPT_WRITEDATA, &answer.body);
  curl_easy_setopt(request.get(), CURLOPT_TIMEOUT_MS, patience_ms);
  curl_easy_setopt(request.get(), CURLOPT_NOSIGNAL, 1L);
  curl_easy_setopt(request.get(), CURLOPT_QUICK_EXIT, 1L);  // a name that is being looked up cannot be stopped
  if (what.is_over) {
    curl_easy_setopt(request.get(), CURLOPT_NOPROGRESS, 0L);
    curl_easy_setopt(request.get(), CURLOPT_XFERINFOFUNCTION, &stops);
    curl_easy_setopt(request.get(), CURLOPT_XFERINFODATA, &what);
  }
  const CURLcode code = curl_easy_perform(request.get());
  if (code != CURLE_OK) answer.problem = problem_of(code, request.get(), patience_ms);
  else curl_easy_getinfo(request.get(), CURLINFO_RESPONSE_CODE, &answer.status);
}

}  // namespace
}  // namespace collided::http

extern "C" __attribute__((visibility("default"))) const collided::http::HttpModule& collided_http_module() {
  // Before its threads use it.
  static const CURLcode set_up = curl_global_init(CURL_GLOBAL_DEFAULT);
  static_cast<void>(set_up);
  static constexpr collided::http::HttpModule kModule{.is_web_address = collided::http::is_web_address,
                                                      .post = collided::http::post};
  return kModule;
}
