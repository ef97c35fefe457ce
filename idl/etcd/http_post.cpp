#include "idl/etcd/http_post.hpp"

#include <curl/curl.h>

#include <algorithm>
#include <cerrno>
#include <memory>
#include <system_error>

namespace collided::etcd {
namespace {

std::string url_of(const EtcdEndpoint& to, const std::string& target) {
  const bool is_address_6 = to.host.find(':') != std::string::npos;
  return "http://" + (is_address_6 ? "[" + to.host + "]" : to.host) + ":" + to.port + target;
}

/// libcurl ends a transfer of which not all is taken.
std::size_t take(char* bytes, std::size_t, std::size_t count, void* to) {
  std::string& body = *static_cast<std::string*>(to);
  if (body.size() + count > kMostHttpBodyBytes) return 0;
  body.append(bytes, count);
  return count;
}

std::string problem_of(CURLcode code, CURL* request) {
  if (code == CURLE_COULDNT_RESOLVE_HOST) return "its name is not known";
  if (code != CURLE_COULDNT_CONNECT) return std::string("its answer: ") + curl_easy_strerror(code);
  long fault = 0;
  curl_easy_getinfo(request, CURLINFO_OS_ERRNO, &fault);
  return std::generic_category().message(fault == 0 ? ECONNREFUSED : static_cast<int>(fault));
}

}  // namespace

HttpAnswer http_post(const EtcdEndpoint& to, const std::string& target, const std::string& body,
                     std::int64_t patience_ns) {
  static const CURLcode set_up = curl_global_init(CURL_GLOBAL_DEFAULT);
  const std::unique_ptr<CURL, decltype(&curl_easy_cleanup)> request(curl_easy_init(), curl_easy_cleanup);
  // Without "Expect" libcurl would wait for the other side before it sends a long body.
  curl_slist* headers = curl_slist_append(nullptr, "Content-Type: application/json");
  headers = curl_slist_append(headers, "Expect:");
  const std::unique_ptr<curl_slist, decltype(&curl_slist_free_all)> held(headers, curl_slist_free_all);
  if (set_up != CURLE_OK || !request || !headers) throw HttpError("libcurl cannot be used");
  const std::string url = url_of(to, target);
  const long patience_ms = std::max<long>(1, static_cast<long>(patience_ns / 1'000'000));
  HttpAnswer answer;
  curl_easy_setopt(request.get(), CURLOPT_URL, url.c_str());
  curl_easy_setopt(request.get(), CURLOPT_PROTOCOLS_STR, "http");
  curl_easy_setopt(request.get(), CURLOPT_PROXY, "");  // what the environment names is for the web
  curl_easy_setopt(request.get(), CURLOPT_HTTPHEADER, headers);
  curl_easy_setopt(request.get(), CURLOPT_POSTFIELDS, body.data());
  curl_easy_setopt(request.get(), CURLOPT_POSTFIELDSIZE_LARGE, static_cast<curl_off_t>(body.size()));
  curl_easy_setopt(request.get(), CURLOPT_WRITEFUNCTION, &take);
  curl_easy_setopt(request.get(), CURLOPT_WRITEDATA, &answer.body);
  curl_easy_setopt(request.get(), CURLOPT_TIMEOUT_MS, patience_ms);
  curl_easy_setopt(request.get(), CURLOPT_NOSIGNAL, 1L);
  curl_easy_setopt(request.get(), CURLOPT_QUICK_EXIT, 1L);  // a name that is being looked up cannot be stopped
  const CURLcode code = curl_easy_perform(request.get());
  if (code == CURLE_OPERATION_TIMEDOUT) throw HttpError("no answer within " + std::to_string(patience_ms) + " ms");
  if (code != CURLE_OK) throw HttpError(problem_of(code, request.get()));
  curl_easy_getinfo(request.get(), CURLINFO_RESPONSE_CODE, &answer.status);
  return answer;
}

}  // namespace collided::etcd
