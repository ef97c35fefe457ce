#include "client/cli/run.hpp"

int main(int argument_count, char** arguments) {
  return collided::cli::run_process(argument_count, arguments, {.verbs = {{"draw", collided::cli::make_draw}}});
}
