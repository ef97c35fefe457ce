#include <collided/client.hpp>

#include <iostream>

// As small as a user's first program: what lies under a point of the server that the environment names.
int main() {
  auto client = collided::Client::connect();
  if (!client) {
    std::cerr << client.error().message << '\n';
    return 4;
  }
  const auto answer = client->ask(collided::RayQuestion{.origin = {0, 0, 5}, .direction = {0, 0, -1}});
  if (!answer || answer->verdict != collided::Verdict::hit) return 1;
  std::cout << answer->hits[0].object << '\n';
  return 0;
}
