#include <collided/client.hpp>

#include <iostream>

// Where no server runs, connecting must fail with its own error, in about the time given.
int main() {
  using namespace std::chrono_literals;
  const auto start = std::chrono::steady_clock::now();
  const collided::Result<collided::Client> client =
      collided::Client::connect({.domain = 199, .name_space = "nobody/here", .wait = 300ms});
  const auto took = std::chrono::steady_clock::now() - start;
  if (client) {
    std::cerr << "a server answered where none should run\n";
    return 1;
  }
  std::cout << collided::library_version() << ": " << client.error().message << '\n';
  const bool good = client.error().code == collided::ErrorCode::no_server && took >= 300ms && took < 3s;
  return good ? 0 : 1;
}
