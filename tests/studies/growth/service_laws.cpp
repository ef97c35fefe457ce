#include "tests/studies/growth/service_laws.hpp"

#include <sstream>
#include <stdexcept>

namespace collided::growth {

std::vector<Law> service_laws(const std::string& lines) {
  std::vector<Law> laws{
      {.knob = "clients",
       .what = "single ray, all ask: wall",
       .unit = "us",
       .theory = {0},
       .reason = "clients and server share the cores of one machine"},
      {.knob = "clients",
       .what = "single ray, all ask: server",
       .unit = "us",
       .theory = {0},
       .reason = "the more that ask at once, the more questions a thread takes at each waking"},
      {.knob = "subscribers",
       .what = "event until all have it: wall",
       .unit = "us",
       .theory = {1},
       .reason = "before an event goes to anybody it costs a flush, a step and a waking, whoever listens"},
      {.knob = "subscribers",
       .what = "event: server",
       .unit = "us",
       .theory = {0},
       .reason = "each reader acknowledges what it got, and the server takes that"}};
  std::istringstream input(lines);
  std::string line;
  while (std::getline(input, line)) {
    std::istringstream words(line);
    std::size_t law = 0;
    Sample sample;
    if (!(words >> law >> sample.x >> sample.low >> sample.median >> sample.high) || law >= laws.size())
      throw std::runtime_error("no measurement: '" + line + "'");
    laws[law].samples.push_back(sample);
  }
  return laws;
}

}  // namespace collided::growth
