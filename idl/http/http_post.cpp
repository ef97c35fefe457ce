#include "idl/http/http_post.hpp"

#include "idl/module.hpp"

namespace collided::http {

const HttpModule& http_module(const std::string& purpose) {
  return reinterpret_cast<HttpModuleFunction>(module_function("collided-http.so", kHttpModule, purpose))();
}

}  // namespace collided::http
